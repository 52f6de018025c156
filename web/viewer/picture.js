// The mean of many frames, and its display.
// twin: src/gl/picture_sum.cpp, src/gl/present_pass.cpp.
import { HalfFloatType, NearestFilter, WebGLRenderTarget } from 'three';
import { ShaderProgram, createFramebuffer, createTexture2D } from '../src/gl.js';

export const kAgx = 1; // twin: shaders/lib/tone_map.glsl

export class Picture {
    constructor(renderer) {
        this.renderer = renderer;
        this.samples = 0;
        this.target = new WebGLRenderTarget(1, 1, {
            type: HalfFloatType,
            minFilter: NearestFilter,
            magFilter: NearestFilter,
        });
        renderer.domElement.addEventListener('webglcontextrestored', () => this.forget());
        this.forget();
    }

    forget() {
        this.gpu = null;
        this.samples = 0;
    }

    setSize(width, height) {
        if (this.target.width === width && this.target.height === height) return;
        this.target.setSize(width, height);
        if (this.gpu) this.renderer.getContext().deleteTexture(this.gpu.sum);
        if (this.gpu) this.renderer.getContext().deleteFramebuffer(this.gpu.framebuffer);
        this.forget();
    }

    create() {
        const gl = this.renderer.getContext(),
            { width, height } = this.target;
        // Half floats can always be added up; some devices cannot add floats.
        const format = gl.getExtension('EXT_float_blend') ? gl.RGBA32F : gl.RGBA16F;
        const sum = createTexture2D(gl, format, width, height);
        return {
            sum,
            framebuffer: createFramebuffer(gl, [sum]),
            noVertices: gl.createVertexArray(),
            accumulate: new ShaderProgram(gl, 'fullscreen.vert', 'accumulate.frag'),
            present: new ShaderProgram(gl, 'fullscreen.vert', 'present.frag'),
        };
    }

    // Draws the scene and adds it; what was there before counts as fewer than `most` samples.
    add(scene, camera, most) {
        this.target.scissorTest = false;
        this.draw(scene, camera);
        this.accumulate(most);
    }

    // Draws some of its rows, which `accumulate` adds with all others once they are drawn.
    drawRows(scene, camera, first, count) {
        const { target } = this;
        target.scissorTest = true;
        target.scissor.set(0, first, target.width, count);
        this.draw(scene, camera);
    }

    draw(scene, camera) {
        this.renderer.setRenderTarget(this.target);
        this.renderer.render(scene, camera);
    }

    accumulate(most) {
        const { renderer, target } = this,
            gl = renderer.getContext();
        this.gpu ??= this.create();
        this.begin(gl, this.gpu.framebuffer);
        if (this.samples === 0) gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
        gl.enable(gl.BLEND);
        gl.blendEquation(gl.FUNC_ADD);
        const kept = Math.min((most - 1) / this.samples, 1);
        gl.blendColor(0, 0, 0, kept);
        gl.blendFunc(gl.ONE, gl.CONSTANT_ALPHA);
        const { accumulate } = this.gpu;
        accumulate.use();
        accumulate.bind('picture', 0, gl.TEXTURE_2D, renderer.properties.get(target.texture).__webglTexture);
        this.end(gl);
        this.samples = kept * this.samples + 1;
    }

    // Shows it in a canvas of its size.
    present(exposureStops, toneMapping = kAgx) {
        const { renderer } = this,
            gl = renderer.getContext(),
            { width, height } = this.target,
            { present, sum } = this.gpu;
        if (gl.drawingBufferWidth !== width || gl.drawingBufferHeight !== height)
            renderer.setDrawingBufferSize(width, height, 1);
        this.begin(gl, null);
        present.use();
        for (const [side, unit] of [
            ['left', 0],
            ['right', 1],
        ]) {
            present.bind(side, unit, gl.TEXTURE_2D, sum);
            present.set(`${side}Scale`, 1 / this.samples);
            present.set(`${side}ToneMapping`, toneMapping);
            present.set(`${side}ExposureStops`, exposureStops);
            present.set(`${side}Heat`, 0);
        }
        present.set('corner', [0, 0]);
        present.set('size', [width, height]);
        present.set('wipe', width);
        present.set('difference', 0);
        this.end(gl);
    }

    // Mean linear radiance, RGBA, row 0 at the bottom.
    read() {
        const gl = this.renderer.getContext(),
            { width, height } = this.target;
        const pixels = new Float32Array(4 * width * height);
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.gpu.framebuffer);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, pixels);
        this.renderer.resetState();
        return pixels.map((x) => x / this.samples);
    }

    begin(gl, framebuffer) {
        gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
        for (const switched of [gl.BLEND, gl.SCISSOR_TEST, gl.STENCIL_TEST, gl.CULL_FACE, gl.DEPTH_TEST])
            gl.disable(switched);
        gl.colorMask(true, true, true, true);
        gl.viewport(0, 0, this.target.width, this.target.height);
        gl.bindVertexArray(this.gpu.noVertices);
    }

    end(gl) {
        gl.drawArrays(gl.TRIANGLES, 0, 3);
        gl.bindVertexArray(null);
        this.renderer.resetState();
    }
}
