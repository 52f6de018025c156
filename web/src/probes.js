// The light probes of a baked file as tables that shaders/lib/probe_light.glsl reads.
// twin: src/gl/probe_upload.cpp.
import { DataTexture, NearestFilter, RGBAIntegerFormat, UnsignedIntType, Vector3 } from 'three';
import { fail, readPayload } from './file.js';
import { kTableWidth } from './tables.js';

const kDistanceIntervals = 3; // twin: kDistanceIntervals in src/core/probes/probe_distances.h
const kDistanceNodes = 2 * kDistanceIntervals + 1;
const kShWords = 7;

// Two texels a probe and source: the light, and after that of indirect light the place.
function lightWords(count, places, indirect, area) {
    const perProbe = area ? 16 : 8,
        words = new Uint32Array(perProbe * count);
    for (let i = 0; i < count; ++i) {
        words.set(indirect.subarray(kShWords * i, kShWords * (i + 1)), perProbe * i);
        words[perProbe * i + kShWords] = places[i];
        if (area) words.set(area.subarray(kShWords * i, kShWords * (i + 1)), perProbe * i + 8);
    }
    return words;
}

// The corners of each square of the octahedron in a word; the four quarters are mirrored to the first.
export function distanceWords(count, codes) {
    const perQuarter = kDistanceIntervals * kDistanceIntervals,
        words = new Uint32Array(4 * perQuarter * count);
    for (let i = 0; i < words.length; ++i) {
        const probe = Math.floor(i / (4 * perQuarter)),
            within = i % (4 * perQuarter),
            quarter = Math.floor(within / perQuarter),
            x = within % kDistanceIntervals,
            y = Math.floor(within / kDistanceIntervals) % kDistanceIntervals;
        for (let corner = 0; corner < 4; ++corner) {
            const nodeX = kDistanceIntervals + (quarter & 1 ? -1 : 1) * (x + (corner & 1)),
                nodeY = kDistanceIntervals + (quarter >> 1 ? -1 : 1) * (y + (corner >> 1));
            words[i] |= codes[kDistanceNodes * kDistanceNodes * probe + kDistanceNodes * nodeY + nodeX] << (8 * corner);
        }
    }
    return words;
}

function table(words) {
    const rows = Math.max(1, Math.ceil(words.length / 4 / kTableWidth)),
        padded = new Uint32Array(4 * kTableWidth * rows);
    padded.set(words);
    const texture = new DataTexture(padded, kTableWidth, rows, RGBAIntegerFormat, UnsignedIntType);
    texture.internalFormat = 'RGBA32UI';
    texture.minFilter = texture.magFilter = NearestFilter;
    texture.needsUpdate = true;
    return texture;
}

// The uniforms of probe_light.glsl.
export async function readProbes(parser, description) {
    const { probes } = description;
    if (!probes) fail('the file has no light probes; bake it again');
    const { count, cellCount } = probes;
    const [cells, places, indirect, area, distances] = await Promise.all([
        readPayload(parser, probes.cells, Uint16Array, 8 * cellCount, "the probes' cells"),
        readPayload(parser, probes.places, Uint32Array, count, "the probes' places"),
        readPayload(parser, probes.indirect, Uint32Array, kShWords * count, "the probes' light"),
        probes.area
            ? readPayload(parser, probes.area, Uint32Array, kShWords * count, "the probes' area light")
            : null,
        readPayload(parser, probes.distances, Uint8Array, kDistanceNodes * kDistanceNodes * count, "the probes' distances"),
    ]);
    return {
        probeCells: { value: table(new Uint32Array(cells.buffer)) },
        probeLight: { value: table(lightWords(count, places, indirect, area)) },
        probeDistances: { value: table(distanceWords(count, distances)) },
        probeLow: { value: new Vector3(...probes.low) },
        probeCellMeters: { value: new Vector3(...probes.cellSize) },
        probeGrid: { value: new Vector3(...probes.grid) },
        probeTexels: { value: area ? 4 : 2 },
    };
}
