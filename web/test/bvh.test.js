// Rays of shaders/lib/bvh.glsl in a browser: the hits of their twin on the CPU, which tests/gl/bvh_fixture_test.cpp keeps
// up to date.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { after, before, test } from 'node:test';
import { borrowBrowser } from './browser.js';

const repository = new URL('../../', import.meta.url);
const read = (name) => readFile(new URL(name, repository), 'utf8');
const tableWidth = 2048,
    raysWidth = 64;
let borrowed, page;

before(async () => {
    borrowed = await borrowBrowser('swiftshader');
    page = await borrowed.value.newPage();
});
after(async () => {
    await page?.close();
    await borrowed?.dispose();
});

// As src/gl.js does, of files that are not in the package.
async function assembleShader(name, defines) {
    const [, preamble] = (await read('web/src/gl.js')).match(/^const preamble = `([^`]*)`/m);
    const included = new Set();
    const expand = async (file) => {
        if (included.has(file)) return '';
        included.add(file);
        const parts = (await read(`shaders/${file}`)).split(/^#include "(.*)"$/m);
        for (let i = 1; i < parts.length; i += 2) parts[i] = await expand(parts[i]);
        return parts.join('');
    };
    return preamble + defines.map((define) => `#define ${define}\n`).join('') + (await expand(name));
}

// Arrays of words by the samplers that read them, uniforms, and the twin's hits.
async function readFixture() {
    const bytes = await readFile(new URL('tests/data/bvh/rooms.bin', repository));
    const words = new Uint32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
    const [nodes, triangles, opacity, alphas, rays, root, firstTransparent, firstMaterial] = words;
    let at = 16;
    const take = (count) => Array.from(words.subarray(at, (at += count)));
    return {
        uniforms: { bvhRoot: root, bvhFirstTransparent: firstTransparent, bvhFirstMaterial: firstMaterial },
        gridStep: Array.from(new Float32Array(words.slice(8, 11).buffer)),
        rays,
        textures: {
            bvhNodes: take(12 * nodes),
            bvhTriangles: take(8 * triangles),
            bvhOpacity: take(4 * opacity),
            bvhAlphas: take(Math.ceil(alphas / 4)),
            rayOrigins: take(4 * rays),
            rayDirections: take(4 * rays),
        },
        hits: new Float32Array(new Uint32Array(take(4 * rays)).buffer),
    };
}

// Runs in the page.
function trace({ vertex, fragment, fixture, tableWidth, raysWidth }) {
    const height = fixture.rays / raysWidth;
    const canvas = document.createElement('canvas'),
        gl = canvas.getContext('webgl2');
    if (!gl.getExtension('EXT_color_buffer_float')) throw new Error('no float targets');
    const program = gl.createProgram();
    for (const [stage, text] of [
        [gl.VERTEX_SHADER, vertex],
        [gl.FRAGMENT_SHADER, fragment],
    ]) {
        const shader = gl.createShader(stage);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
        gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    const texture = (internal, format, type, width, data) => {
        gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
        const channels = format === gl.RED ? 1 : 4,
            rows = Math.max(Math.ceil((data?.length ?? 0) / channels / width), 1);
        let padded = null;
        if (data) {
            padded = new data.constructor(width * rows * channels);
            padded.set(data);
        }
        gl.texImage2D(gl.TEXTURE_2D, 0, internal, width, data ? rows : height, 0, format, type, padded);
        for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
            gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
        return gl.getParameter(gl.TEXTURE_BINDING_2D);
    };
    const target = texture(gl.RGBA32F, gl.RGBA, gl.FLOAT, raysWidth, null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
    Object.entries(fixture.textures).forEach(([name, numbers], unit) => {
        gl.activeTexture(gl.TEXTURE0 + unit);
        const data = new Uint32Array(numbers);
        if (name.startsWith('ray'))
            texture(gl.RGBA32F, gl.RGBA, gl.FLOAT, raysWidth, new Float32Array(data.buffer));
        else if (name === 'bvhAlphas')
            texture(gl.R8, gl.RED, gl.UNSIGNED_BYTE, tableWidth, new Uint8Array(data.buffer));
        else texture(gl.RGBA32UI, gl.RGBA_INTEGER, gl.UNSIGNED_INT, tableWidth, data);
        gl.uniform1i(gl.getUniformLocation(program, name), unit);
    });
    for (const [name, value] of Object.entries(fixture.uniforms))
        gl.uniform1i(gl.getUniformLocation(program, name), value);
    gl.uniform3fv(gl.getUniformLocation(program, 'bvhGridStep'), fixture.gridStep);
    gl.viewport(0, 0, raysWidth, height);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const hits = new Float32Array(4 * fixture.rays);
    gl.readPixels(0, 0, raysWidth, height, gl.RGBA, gl.FLOAT, hits);
    return { hits: Array.from(hits), error: gl.getError() };
}

test('rays in a browser hit what their twin on the CPU hits', async () => {
    const fixture = await readFixture();
    const [vertex, fragment] = await Promise.all([
        assembleShader('fullscreen.vert', []),
        assembleShader('trace_rays.frag', ['BVH_OPACITY']),
    ]);
    const result = await page.evaluate(trace, {
        vertex,
        fragment,
        fixture: { ...fixture, hits: undefined },
        tableWidth,
        raysWidth,
    });
    assert.equal(result.error, 0);
    let hits = 0,
        different = 0,
        transparent = 0;
    for (let i = 0; i < fixture.rays; ++i) {
        const [distance, number, u, v] = fixture.hits.subarray(4 * i, 4 * i + 4),
            [isDistance, isNumber, isU, isV] = result.hits.slice(4 * i, 4 * i + 4);
        hits += number !== 0;
        transparent += Math.abs(number) > fixture.uniforms.bvhFirstTransparent;
        const near =
            Math.abs(isDistance - distance) < 1e-4 && Math.abs(isU - u) + Math.abs(isV - v) < 1e-2;
        different += isNumber !== number || !near;
    }
    assert.ok(hits > 0.9 * fixture.rays && transparent > 50, `${hits}, ${transparent}`);
    // Where rounding decides: rays within some units in the last place of an edge, or slivers.
    assert.ok(different <= 3, `${different} of ${hits} differ`);
});
