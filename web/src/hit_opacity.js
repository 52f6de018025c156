// What shaders need to know whether a ray passes a triangle that is masked or blended.
// twin: src/gl/bvh_opacity.cpp, shaders/lib/bvh_opacity.glsl.
import { ClampToEdgeWrapping, MirroredRepeatWrapping, NearestFilter } from 'three';
import { ShaderProgram, createFramebuffer, createTexture2D } from './gl.js';
import { resetState } from './fixed.js';
import { matrixOf } from './hit_materials.js';
import { alphaMode, kMask, kOpaque } from './material.js';
import { kVertexWords } from './surfaces.js';
import { createTable, kTableWidth } from './tables.js';
import { webglTexture } from './three_internals.js';

const kWrapMirrored = 1,
    kWrapClamped = 2,
    kNearestTexel = 16,
    kHasPicture = 32,
    kIsMasked = 64;

function wrapOf(wrap) {
    return wrap === MirroredRepeatWrapping ? kWrapMirrored : wrap === ClampToEdgeWrapping ? kWrapClamped : 0;
}

// Where the alphas of each picture that transparent materials read begin in their table: { firsts, count }.
function placePictures(renderer, materials) {
    const firsts = new Map();
    let count = 0;
    for (const { map, ...m } of materials.map((m) => ({ map: m.map, mode: alphaMode(m) }))) {
        if (m.mode === kOpaque || !map || firsts.has(map) || !webglTexture(renderer, map)) continue;
        firsts.set(map, count);
        count += map.image.width * map.image.height;
    }
    return { firsts, count };
}

function materialWords(m, firsts) {
    const words = new Uint32Array(12),
        floats = new Float32Array(words.buffer),
        { map } = m,
        mode = alphaMode(m),
        t = matrixOf(map);
    const hasPicture = firsts.has(map) && mode !== kOpaque;
    floats.set([mode === kOpaque ? 1 : (m.opacity ?? 1), m.alphaTest ?? 0.5], 0);
    words[2] = hasPicture ? firsts.get(map) : 0;
    words[3] =
        (mode === kMask ? kIsMasked : 0) |
        (map?.magFilter === NearestFilter ? kNearestTexel : 0) |
        (hasPicture ? kHasPicture : 0) |
        (map ? wrapOf(map.wrapS) | (wrapOf(map.wrapT) << 2) : 0);
    if (hasPicture) words.set([map.image.width, map.image.height], 4);
    floats.set([t[6], t[7], t[0], t[3], t[1], t[4]], 6);
    return words;
}

function triangleWords({ vertices, indices }, triangle, map, material) {
    const words = new Uint32Array(12),
        floats = new Float32Array(words.buffer),
        from = new Float32Array(vertices.buffer),
        channel = map?.channel === 1 ? 12 : 10;
    for (let i = 0; i < 3; ++i) {
        const at = kVertexWords * indices[3 * triangle + i];
        floats.set(from.subarray(at + channel, at + channel + 2), 2 * i);
        floats[8 + i] = from[at + 17];
    }
    words.set([triangle, material], 6);
    return words;
}

function drawAlphas(gl, renderer, { firsts, count }, noVertices) {
    const rows = Math.max(Math.ceil(count / kTableWidth), 1),
        alphas = createTexture2D(gl, gl.R8, kTableWidth, rows);
    if (count === 0) return alphas;
    const framebuffer = createFramebuffer(gl, [alphas]),
        program = new ShaderProgram(gl, 'fullscreen.vert', 'picture_alphas.frag');
    resetState(gl, kTableWidth, rows);
    gl.bindVertexArray(noVertices);
    program.use();
    for (const [map, first] of firsts) {
        program.bind('picture', 0, gl.TEXTURE_2D, webglTexture(renderer, map));
        program.set('firstTexel', first);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }
    program.dispose();
    gl.deleteFramebuffer(framebuffer);
    return alphas;
}

// { opacity, alphas, firstMaterial }. pre: some triangles are transparent, and the textures are uploaded.
export function createOpacity(gl, renderer, { surfaces, trees, materials }, noVertices) {
    const { order, surfaceOf, firstTransparent } = trees,
        transparent = order.subarray(firstTransparent),
        words = new Uint32Array(12 * (transparent.length + materials.length)),
        pictures = placePictures(renderer, materials);
    const numbers = new Map(materials.map((m, i) => [m, i]));
    transparent.forEach((triangle, i) => {
        const { material } = surfaces.drawRanges[surfaceOf[triangle]].mesh;
        words.set(triangleWords(surfaces, triangle, material.map, numbers.get(material)), 12 * i);
    });
    materials.forEach((m, i) => words.set(materialWords(m, pictures.firsts), 12 * (transparent.length + i)));
    return {
        opacity: createTable(gl, gl.RGBA32UI, words),
        alphas: drawAlphas(gl, renderer, pictures, noVertices),
        firstMaterial: 3 * transparent.length,
    };
}
