// The table that shaders/lib/hit_surface.glsl reads: materials, triangles in the order of the leaves, emitters.
// twin: src/gl/hit_tables.cpp, findEmissiveTriangles in src/core/scene/light_emitters.cpp.
import { DoubleSide } from 'three';
import { aliasTable } from './alias_table.js';
import { half, luminance, octahedral, packDirection } from './file.js';
import { kChartsOffset, kVertexWords } from './surfaces.js';
import { emissionMap, emissionOf, isUnlit } from './material.js';
import { glassOfSurfaces } from './hit_glass.js';
import { kMaterialWords, kMeansSide, matrixOf, packHitMaterial, placedMap } from './hit_materials.js';

export const kTriangleWords = 24;
export const kEmitterWords = 16;
// Points of a triangle at which a picture of what shines is read.
const kEmissionSamples = 64;

const minus = (a, b) => a.map((x, i) => x - b[i]);
const length = (v) => Math.hypot(...v);
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];

// What a table is made of: corners of the triangles as gatherSurfaces has them.
class Corners {
    constructor({ vertices, indices }) {
        this.words = vertices;
        this.floats = new Float32Array(vertices.buffer);
        this.indices = indices;
    }

    // Where the three corners of a triangle begin.
    of(triangle) {
        return [0, 1, 2].map((i) => kVertexWords * this.indices[3 * triangle + i]);
    }

    position(at) {
        return [...this.floats.subarray(at, at + 3)];
    }

    uv(at, texture) {
        const from = at + (texture?.channel === 1 ? 12 : 10),
            [u, v] = this.floats.subarray(from, from + 2),
            m = matrixOf(texture);
        return [m[0] * u + m[3] * v + m[6], m[1] * u + m[4] * v + m[7]];
    }
}

function packColor(rgb) {
    const [r, g, b] = [...rgb].map((x) => Math.floor(Math.min(Math.max(x, 0), 1) * 255 + 0.5));
    return r | (g << 8) | (b << 16);
}

const kMaxTangent = 2046; // twin: src/gl/hit_tables.cpp

// Three bytes: octahedral, the handedness plus 2. `tangent`: the sum of the corners'; 0 where they have none.
function packTangent([x, y, z, handedness]) {
    if (length([x, y, z]) < 1e-6) return [0, 0, 0];
    const [u, v] = octahedral([x, y, z]).map((e) => Math.floor(Math.min(Math.max(0.5 * e + 0.5, 0), 1) * kMaxTangent + 0.5)),
        code = u | (v << 11) | ((handedness < 0 ? 1 : 3) << 22);
    return [code & 255, (code >> 8) & 255, (code >> 16) & 255];
}

// Lengths of texture coordinates over those of the surface, 1/m.
function uvPerMeter(positions, uvs) {
    const area = length(cross(minus(positions[1], positions[0]), minus(positions[2], positions[0])));
    const a = minus(uvs[1], uvs[0]),
        b = minus(uvs[2], uvs[0]);
    return area > 0 ? Math.sqrt(Math.abs(a[0] * b[1] - a[1] * b[0]) / area) : 0;
}

function writeTriangle(table, at, corners, triangle, { material, map, glass, emitter }) {
    const { words, floats } = corners,
        out = new Float32Array(table.buffer),
        places = corners.of(triangle),
        uvs = places.map((place) => corners.uv(place, map)),
        tangent = packTangent([6, 7, 8, 9].map((i) => places.reduce((sum, place) => sum + floats[place + i], 0))),
        [first] = places;
    places.forEach((place, i) => {
        // Texels of the front: words 0 to 5; normals: 8 to 10; texture coordinates: 12 to 17; colours and, in their
        // upper bytes, the tangent: 20 to 22.
        out.set(floats.subarray(place + 18, place + 20), at + 2 * i);
        table[at + 8 + i] = packDirection(floats.subarray(place + 3, place + 6));
        out.set(uvs[i], at + 12 + 2 * i);
        table[at + 20 + i] = (packColor(floats.subarray(place + 14, place + 17)) | (tangent[i] << 24)) >>> 0;
    });
    table.set(words.subarray(first + kChartsOffset, first + kChartsOffset + 2), at + 6);
    table[at + 11] = material + glass.bits;
    const [x, y] = [0, 1].map((axis) => Math.round(floats[first + 20 + axis] - floats[first + 18 + axis]));
    table[at + 18] = ((x & 0xffff) | (y << 16)) >>> 0;
    const density = uvPerMeter(places.map((place) => corners.position(place)), uvs);
    table[at + 19] = (half(density) | (half(glass.thickness) << 16)) >>> 0;
    table[at + 23] = emitter;
}

// The mean radiance of a triangle that shines, if its picture is `means` (HitImages.meansOf), or none.
function meanEmission(corners, triangle, m, means) {
    const emitted = emissionOf(m);
    if (!means) return emitted;
    const uvs = corners.of(triangle).map((place) => corners.uv(place, emissionMap(m))),
        fract = (x) => x - Math.floor(x),
        sum = [0, 0, 0];
    for (let i = 0; i < kEmissionSamples; ++i) {
        // Additive recurrence of the plastic number. source: Roberts 2018, "R2".
        let [s, t] = [fract(0.5 + 0.7548776662466927 * i), fract(0.5 + 0.5698402909980532 * i)];
        if (s + t > 1) [s, t] = [1 - s, 1 - t];
        const [x, y] = [0, 1].map((axis) => {
            const at = uvs[0][axis] + s * (uvs[1][axis] - uvs[0][axis]) + t * (uvs[2][axis] - uvs[0][axis]);
            return Math.floor(kMeansSide * fract(at));
        });
        for (let c = 0; c < 3; ++c) sum[c] += means[4 * (y * kMeansSide + x) + c];
    }
    return emitted.map((x, c) => (x * sum[c]) / kEmissionSamples);
}

// Triangles that shine: { triangle, radiance, area, doubleSided }.
function findEmitters(corners, drawRanges, images) {
    const emitters = [];
    for (const { mesh, first, count } of drawRanges) {
        const m = mesh.material;
        if (!emissionOf(m).some((x) => x > 0)) continue;
        const means = images.meansOf(emissionMap(m)),
            opacity = m.transparent ? (m.opacity ?? 1) : 1;
        for (let triangle = first / 3; triangle < (first + count) / 3; ++triangle) {
            const [a, b, c] = corners.of(triangle).map((place) => corners.position(place)),
                area = 0.5 * length(cross(minus(b, a), minus(c, a))),
                radiance = meanEmission(corners, triangle, m, means).map((x) => opacity * x);
            if (!(area > 0 && luminance(radiance) > 0)) continue;
            emitters.push({ triangle, radiance, area, corners: [a, b, c], doubleSided: m.side === DoubleSide });
        }
    }
    return emitters;
}

// Sixteen words an emitter.
function emitterRows(emitters) {
    const table = new Uint32Array(kEmitterWords * emitters.length),
        out = new Float32Array(table.buffer),
        powers = emitters.map((e) => e.area * (e.doubleSided ? 2 : 1) * luminance(e.radiance)),
        sum = powers.reduce((a, b) => a + b, 0),
        chances = powers.map((power) => power / sum),
        { thresholds, aliases } = aliasTable(chances);
    emitters.forEach(({ corners, radiance, area, doubleSided }, i) => {
        const at = kEmitterWords * i,
            density = chances[i] / area;
        out.set([...corners[0], thresholds[i]], at);
        out.set(corners[1], at + 4);
        table[at + 7] = aliases[i];
        out.set([...corners[2], 0], at + 8);
        out.set([...radiance, doubleSided ? -density : density], at + 12);
    });
    return table;
}

// The same of all surfaces as they are now.
export function emittersOf(surfaces, images) {
    return emitterRows(findEmitters(new Corners(surfaces), surfaces.drawRanges, images));
}

// How rays pass the surfaces, wherever they are moved: what surfaceRows takes for `glass`.
export function glassRows(surfaces, images) {
    const corners = new Corners(surfaces);
    return glassOfSurfaces(surfaces, images, (vertex) => corners.position(kVertexWords * vertex));
}

// What a table has of the surfaces: { emitters, trianglesOf }, the second of which returns the rows of `count` triangles in the
// order of the leaves, from the one at `first` on.
export function surfaceRows({ surfaces, trees, materials, images, glass }) {
    const corners = new Corners(surfaces),
        { drawRanges } = surfaces,
        { order, surfaceOf } = trees;
    const emitters = findEmitters(corners, drawRanges, images),
        emitterOf = new Map(emitters.map(({ triangle }, i) => [triangle, i + 1])),
        numbers = new Map(materials.map((m, i) => [m, i]));
    const surfaceMaterials = drawRanges.map(({ mesh }, i) => ({
        glass: glass[i],
        material: numbers.get(mesh.material),
        map: placedMap(mesh.material),
    }));
    const trianglesOf = (first, count) => {
        const rows = new Uint32Array(kTriangleWords * count);
        order.subarray(first, first + count).forEach((triangle, i) => {
            const of = { ...surfaceMaterials[surfaceOf[triangle]], emitter: emitterOf.get(triangle) ?? 0 };
            writeTriangle(rows, kTriangleWords * i, corners, triangle, of);
        });
        return rows;
    };
    return { emitters: emitterRows(emitters), trianglesOf };
}

// Whether anything that emits also reflects. twin: emittersReflect in src/core/scene/light_bound.cpp.
function emitterReflects(m) {
    if (isUnlit(m) || emissionOf(m).every((x) => x === 0)) return false;
    const dielectric = m.metalness < 1 && (m.specularIntensity ?? 1) > 0;
    return m.color.toArray().some((x) => x !== 0) || dielectric || m.clearcoat > 0;
}

const kUnbounded = 1e30;

// A radiance that nothing exceeds. twin: brightestRadiance in src/core/scene/light_bound.cpp. `environment`: RGBA pixels,
// or none.
export function brightestRadiance(materials, environment, lightCount) {
    if (lightCount > 0 || materials.some(emitterReflects)) return [kUnbounded, kUnbounded, kUnbounded];
    const most = [0, 0, 0];
    const raise = (rgb, at = 0) => {
        for (let c = 0; c < 3; ++c) most[c] = Math.max(most[c], rgb[at + c]);
    };
    materials.forEach((m) => raise(emissionOf(m)));
    for (let at = 0; at < (environment?.length ?? 0); at += 4) raise(environment, at);
    return most.every((x) => x === 0) ? [kUnbounded, kUnbounded, kUnbounded] : most;
}

export function materialRows(materials, images, colored) {
    const rows = new Uint32Array(kMaterialWords * materials.length);
    materials.forEach((m, i) => rows.set(packHitMaterial(m, images, colored), kMaterialWords * i));
    return rows;
}

export function hasColors(vertices) {
    const floats = new Float32Array(vertices.buffer);
    for (let at = 14; at < floats.length; at += kVertexWords)
        if (floats[at] !== 1 || floats[at + 1] !== 1 || floats[at + 2] !== 1) return true;
    return false;
}

// { table, firstTriangle, firstEmitter, emitterCount }; the first two numbers count texels of four words. `rows`: of
// the materials.
export function hitTable({ rows, ...room }) {
    const { emitters, trianglesOf } = surfaceRows(room),
        triangleCount = room.trees.order.length;
    const firstTriangle = rows.length,
        firstEmitter = firstTriangle + kTriangleWords * triangleCount;
    const table = new Uint32Array(firstEmitter + emitters.length);
    table.set(rows);
    table.set(trianglesOf(0, triangleCount), firstTriangle);
    table.set(emitters, firstEmitter);
    return {
        table,
        firstTriangle: firstTriangle / 4,
        firstEmitter: firstEmitter / 4,
        emitterCount: emitters.length / kEmitterWords,
    };
}
