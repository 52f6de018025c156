// The pictures of all materials that rays read, as layers of one size: a shader cannot choose among textures.
// twin: src/gl/hit_images.cpp.
import { ShaderProgram, createFramebuffer, createTexture2D } from './gl.js';
import { resetState } from './fixed.js';
import { kMeansSide, kNoLayer } from './hit_materials.js';
import { emissionMap, metallicRoughnessMap } from './material.js';
import { webglTexture } from './three_internals.js';

const kMaxSide = 1024,
    kMaxBytes = 32 << 20; // of each array
// Texels along an axis that are read for a mean: enough for all of a picture that is shrunk by this.
const kMaxTexels = 16;

export class HitImages {
    // `materials`: all that rays may meet. pre: their textures are uploaded. Leaves WebGL's state to the caller.
    constructor(gl, renderer, materials, noVertices) {
        this.gl = gl;
        this.renderer = renderer;
        this.noVertices = noVertices;
        this.program = new ShaderProgram(gl, 'fullscreen.vert', 'picture_cells.frag');
        this.means = new Map();
        const colors = new Set(),
            linear = new Set();
        const add = (set, texture) => {
            if (texture && webglTexture(renderer, texture) && set.size < kNoLayer) set.add(texture);
        };
        for (const m of materials) {
            add(colors, m.map);
            add(colors, emissionMap(m));
            add(linear, metallicRoughnessMap(m));
            add(linear, m.normalMap);
        }
        this.colorLayers = this.numbered(colors);
        this.linearLayers = this.numbered(linear);
        this.colors = this.createArray(colors, gl.SRGB8_ALPHA8);
        this.linear = this.createArray(linear, gl.RGBA8);
    }

    numbered(textures) {
        return new Map([...textures].map((texture, layer) => [texture, layer]));
    }

    sideOf(textures) {
        const sizes = [...textures].flatMap(({ image }) => [image?.width ?? 1, image?.height ?? 1]);
        let side = Math.min(2 ** Math.ceil(Math.log2(Math.max(1, ...sizes))), kMaxSide);
        // A third more for the mipmaps.
        while (side > 1 && (side * side * 4 * 4 * textures.size) / 3 > kMaxBytes) side /= 2;
        return side;
    }

    createArray(textures, format) {
        const { gl } = this,
            side = this.sideOf(textures),
            array = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, array);
        gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1 + Math.log2(side), format, side, side, Math.max(textures.size, 1));
        [...textures].forEach((texture, layer) => {
            const framebuffer = createFramebuffer(gl, [{ texture: array, layer }]);
            this.drawMeans(texture, side);
            gl.deleteFramebuffer(framebuffer);
        });
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, array);
        gl.generateMipmap(gl.TEXTURE_2D_ARRAY);
        gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
        gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
        return array; // repeated, as it is by default
    }

    // To the framebuffer that is bound.
    drawMeans(texture, side) {
        const { gl, program } = this;
        resetState(gl, side, side);
        program.use();
        program.bind('picture', 0, gl.TEXTURE_2D, webglTexture(this.renderer, texture));
        program.set('cells', [side, side]);
        program.set('maxTexels', kMaxTexels);
        gl.bindVertexArray(this.noVertices);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    // kMeansSide x kMeansSide RGBA, linear; null without a picture.
    meansOf(texture) {
        if (!texture || !webglTexture(this.renderer, texture)) return null;
        if (this.means.has(texture)) return this.means.get(texture);
        const { gl } = this,
            target = createTexture2D(gl, gl.RGBA32F, kMeansSide, kMeansSide),
            framebuffer = createFramebuffer(gl, [target]),
            pixels = new Float32Array(4 * kMeansSide * kMeansSide);
        this.drawMeans(texture, kMeansSide);
        gl.readPixels(0, 0, kMeansSide, kMeansSide, gl.RGBA, gl.FLOAT, pixels);
        gl.deleteFramebuffer(framebuffer);
        gl.deleteTexture(target);
        this.means.set(texture, pixels);
        return pixels;
    }

    // RGBA of all of a picture; 1 without one.
    meanOf(texture) {
        const means = this.meansOf(texture),
            sum = [0, 0, 0, 0];
        if (!means) return [1, 1, 1, 1];
        means.forEach((x, i) => {
            sum[i % 4] += x;
        });
        return sum.map((x) => x / (kMeansSide * kMeansSide));
    }

    dispose() {
        for (const texture of [this.colors, this.linear]) this.gl.deleteTexture(texture);
        this.program.dispose();
    }
}
