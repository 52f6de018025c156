// The extension PHAT_photon_accumulation_texture of a baked file (docs/format.md).
import { DataUtils } from 'three';

export const kName = 'PHAT_photon_accumulation_texture';
// 5: charts of several surfaces, which are drawn as those of one. 4 is of files in the paper's storage.
const kVersions = [3, 5];
export const kNoChart = 0xffffffff;

// A file may promise few bytes and hold a stream that never ends: no more than `length` are made room for, and what would
// follow is not inflated. Returns what is there, or null where there is more.
async function inflate(compressed, length) {
    const stream = new Blob([compressed]).stream().pipeThrough(new DecompressionStream('deflate')),
        bytes = new Uint8Array(length);
    let end = 0;
    for (const reader = stream.getReader(); ; ) {
        const { done, value } = await reader.read();
        if (done) return bytes.subarray(0, end);
        if (end + value.length > length) {
            await reader.cancel();
            return null;
        }
        bytes.set(value, end);
        end += value.length;
    }
}

export function fail(reason) {
    throw new Error(`the baked light cannot be read: ${reason}`);
}

// A payload as `count` values of `Type`.
export async function readPayload(parser, payload, Type, count, what) {
    if (!payload) fail(`${what} is missing`);
    if (payload.byteLength !== count * Type.BYTES_PER_ELEMENT) fail(`${what} has the wrong size`);
    if (typeof DecompressionStream === 'undefined') fail('this browser has no DecompressionStream');
    const compressed = await parser.getDependency('bufferView', payload.bufferView); // throws what it lacks
    let bytes;
    try {
        bytes = await inflate(compressed, payload.byteLength);
    } catch {
        fail(`${what} is damaged or cut off`);
    }
    if (!bytes) fail(`${what} is larger than the file says`);
    if (bytes.length !== payload.byteLength) fail(`${what} is cut off`);
    return new Type(bytes.buffer);
}

// Charts as docs/format.md lists them, with the number of their first block.
function chartsFrom(words) {
    const floats = new Float32Array(words.buffer);
    const charts = [];
    let firstBlock = 0;
    for (let i = 0; i < words.length; i += 8) {
        const chart = {
            originTile: [words[i], words[i + 1]],
            sizeTiles: [words[i + 2], words[i + 3]],
            surface: words[i + 4],
            back: words[i + 5] !== 0,
            otherSide: words[i + 6],
            texelSizeMeters: floats[i + 7],
            firstBlock,
        };
        chart.blocksWide = Math.ceil(chart.sizeTiles[0] / 4);
        firstBlock += chart.blocksWide * Math.ceil(chart.sizeTiles[1] / 4);
        charts.push(chart);
    }
    return { charts, blockCount: firstBlock };
}

// All but the PHATexels: enough for diffuse light.
export async function readAtlas(parser, description, triangleCount) {
    if (!kVersions.includes(description.version))
        fail(
            `it has format version ${description.version}; this program reads versions ${kVersions.join(' and ')}`,
        );
    if ((description.storage ?? 'packed') !== 'packed')
        fail(`its PHATexels are in a storage that this program does not read, "${description.storage}"`);
    const { atlas, tiles, indirect, area } = description,
        unitMeters = description.lengthUnit ?? 1; // older files have distances in metres
    if (!(unitMeters > 0 && unitMeters < Infinity)) fail('the unit of length is not positive');
    const [width, height] = atlas.size;
    const tileCount = (width / 8) * (height / 8),
        texels = width * height;
    const payload = (of, Type, count, what) => readPayload(parser, of, Type, count, what);
    const [
        chartWords,
        tileChart,
        triangleChart,
        tilePatches,
        radianceBound,
        indirectIrradiance,
        areaIrradiance,
    ] = await Promise.all([
        payload(atlas.charts, Uint32Array, 8 * atlas.chartCount, 'the list of charts'),
        payload(atlas.tiles, Uint32Array, tileCount, 'the list of tiles'),
        payload(atlas.triangles, Uint32Array, triangleCount, 'the list of triangles'),
        payload(tiles.places, Uint32Array, 8 * tileCount, 'the tile patches'),
        payload(tiles.brightest, Float32Array, 3 * tileCount, 'the bound of the light'),
        payload(indirect.irradiance, Uint32Array, texels, 'the indirect irradiance'),
        area.irradiance ? payload(area.irradiance, Uint32Array, texels, "the area lights' irradiance") : null,
    ]);
    return {
        unitMeters,
        width,
        height,
        tileChart,
        triangleChart,
        tilePatches,
        radianceBound,
        indirectIrradiance,
        areaIrradiance,
        ...chartsFrom(chartWords),
    };
}

export function canLookUp(source) {
    return (
        source.guideCount > 0 && source.layers.length > 0 && source.layers.every((layer) => layer.scrambles)
    );
}

// The distances around the tiles: 32 words a tile.
export function readDistances(parser, description, atlas) {
    return readPayload(
        parser,
        description.tiles.distances,
        Uint32Array,
        32 * atlas.tileChart.length,
        'the distances',
    );
}

// One source's guides, 256 weights each.
export function readGuides(parser, source) {
    return readPayload(parser, source.guides, Uint16Array, 256 * source.guideCount, 'the guides');
}

// PHATexels of a layer: radiance and direction in turn; and the blocks' permutations.
export async function readLayer(parser, layer, atlas) {
    const texels = atlas.width * atlas.height;
    const [radiance, direction, scrambles] = await Promise.all([
        readPayload(parser, layer.radiance, Uint32Array, texels, 'the radiance'),
        readPayload(parser, layer.direction, Uint32Array, texels, 'the directions'),
        readPayload(parser, layer.scrambles, Uint16Array, atlas.blockCount, 'the permutations'),
    ]);
    const words = new Uint32Array(2 * texels);
    for (let i = 0; i < texels; ++i) {
        words[2 * i] = radiance[i];
        words[2 * i + 1] = direction[i];
    }
    return { texels: words, scrambles };
}

// Three numbers, times `factor`, to `out` from `at` on. twin: src/core/phatexel/phatexture.h.
export function unpackRgb9e5(bits, out, at, factor = 1) {
    const scale = factor * 2 ** ((bits >>> 27) - 24);
    for (let c = 0; c < 3; ++c) out[at + c] = ((bits >>> (9 * c)) & 511) * scale;
}

// The environment as linear RGBA floats, row 0 at -Y as three.js wants it.
export async function readEnvironment(parser, description) {
    const [width, height] = description.size;
    const packed = await readPayload(
        parser,
        description.radiance,
        Uint32Array,
        width * height,
        'the environment',
    );
    const pixels = new Float32Array(4 * packed.length);
    for (let i = 0; i < packed.length; ++i) {
        const x = i % width,
            y = height - 1 - Math.floor(i / width),
            at = 4 * (y * width + x);
        unpackRgb9e5(packed[i], pixels, at, description.scale);
        pixels[at + 3] = 1;
    }
    return { width, height, pixels };
}

export function half(x) {
    return DataUtils.toHalfFloat(Math.min(Math.max(x, -65504), 65504));
}

export const luminance = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

export function octahedral([x, y, z]) {
    const sum = Math.abs(x) + Math.abs(y) + Math.abs(z) || 1,
        [u, v] = [x / sum, y / sum],
        fold = (a, b) => (1 - Math.abs(b)) * (a >= 0 ? 1 : -1);
    return z < 0 ? [fold(u, v), fold(v, u)] : [u, v];
}

// As octahedral code, twice 16 bits.
export function packDirection(direction) {
    const [x, y] = octahedral(direction),
        code = (t) => Math.round(Math.min(Math.max(t, -1), 1) * 32767) & 0xffff;
    return (code(x) | (code(y) << 16)) >>> 0;
}
