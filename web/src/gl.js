// WebGL 2 objects: programs from shaders/, textures, framebuffers.
// twin: src/gl/shader_loader.h, src/gl/textures.h.
import files from 'phat:shaders';

const preamble = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
precision highp sampler2DArrayShadow;
precision highp usampler2D;
precision highp usampler2DArray;
`;

// Others than those that every room needs.
export function addShaders(more) {
    Object.assign(files, more);
}

// A file of shaders/ with everything that it includes, each once and in order, without a preamble.
export function shaderLibrary(name) {
    const included = new Set();
    const expand = (file) => {
        if (included.has(file)) return '';
        included.add(file);
        return files[file].replace(/^#include "(.*)"$/gm, (_, included) => expand(included));
    };
    return expand(name);
}

export function assembleShader(name, defines = []) {
    return preamble + defines.map((define) => `#define ${define}\n`).join('') + shaderLibrary(name);
}

function compileShader(gl, stage, source) {
    const shader = gl.createShader(stage);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    return shader;
}

export class ShaderProgram {
    constructor(gl, vertexFile, fragmentFile, defines = []) {
        this.gl = gl;
        this.program = gl.createProgram();
        const sources = [vertexFile, fragmentFile].map((file) => assembleShader(file, defines));
        this.declared = new Set(
            sources.flatMap((text) =>
                [...text.matchAll(/^uniform .*?(\w+)(\[.*\])?;/gm)].map((match) => match[1]),
            ),
        );
        this.stages = [
            compileShader(gl, gl.VERTEX_SHADER, sources[0]),
            compileShader(gl, gl.FRAGMENT_SHADER, sources[1]),
        ];
        for (const stage of this.stages) gl.attachShader(this.program, stage);
        gl.linkProgram(this.program);
        this.name = `${vertexFile} and ${fragmentFile}`;
        this.uniforms = null;
    }

    // Whether using it would not wait; true where the browser does not say.
    isReady() {
        if (this.uniforms) return true;
        const extension = this.gl.getExtension('KHR_parallel_shader_compile');
        return !extension || this.gl.getProgramParameter(this.program, extension.COMPLETION_STATUS_KHR);
    }

    // Drivers compile in the background; asking for the result earlier would wait.
    use() {
        const { gl, program } = this;
        gl.useProgram(program);
        if (this.uniforms) return;
        if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
            const log =
                this.stages.map((stage) => gl.getShaderInfoLog(stage)).join('') +
                gl.getProgramInfoLog(program);
            throw new Error(`${this.name} do not compile: ${log.split('\n')[0]}`);
        }
        for (const stage of this.stages) gl.deleteShader(stage);
        this.uniforms = new Map();
        const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS) || 0;
        for (let i = 0; i < count; ++i) {
            const { name, type } = gl.getActiveUniform(program, i);
            this.uniforms.set(name.replace(/\[.*/, ''), {
                type,
                location: gl.getUniformLocation(program, name),
            });
        }
    }

    // pre: in use. Uniforms that the compiler removed are ignored.
    set(name, value) {
        if (!this.declared.has(name)) throw new Error(`${this.name} have no uniform ${name}`);
        const uniform = this.uniforms.get(name);
        if (!uniform) return;
        const { gl } = this,
            { type, location } = uniform;
        if (type === gl.FLOAT) gl.uniform1f(location, value);
        else if (type === gl.FLOAT_VEC2) gl.uniform2fv(location, value);
        else if (type === gl.FLOAT_VEC3) gl.uniform3fv(location, value);
        else if (type === gl.FLOAT_VEC4) gl.uniform4fv(location, value);
        else if (type === gl.INT_VEC2) gl.uniform2iv(location, value);
        else if (type === gl.UNSIGNED_INT_VEC4) gl.uniform4uiv(location, value);
        else if (type === gl.FLOAT_MAT4) gl.uniformMatrix4fv(location, false, value);
        else gl.uniform1i(location, value);
    }

    // Optional properties of programs.
    offer(name, value) {
        if (this.declared.has(name)) this.set(name, value);
    }

    bind(name, unit, target, texture) {
        const { gl } = this;
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(target, texture);
        this.set(name, unit);
    }

    dispose() {
        for (const stage of this.stages) this.gl.deleteShader(stage);
        this.gl.deleteProgram(this.program);
    }
}

function setNearest(gl, target) {
    gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    gl.texParameteri(target, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(target, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
}

function requireSize(gl, width, height) {
    const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    if (Math.max(width, height) > most)
        throw new Error(`a texture of ${width} x ${height} exceeds this device's limit of ${most}`);
}

// `format`: a sized internal format. `data`: of that format's client layout, or null.
export function createTexture2D(gl, format, width, height, data = null) {
    requireSize(gl, width, height);
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
    if (data) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, height, ...clientFormat(gl, format), data);
    setNearest(gl, gl.TEXTURE_2D);
    return texture;
}

// `layers`: an array a layer, or their number.
export function createTextureArray(gl, format, width, height, layers) {
    requireSize(gl, width, height);
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, format, width, height, layers.length ?? layers);
    for (let i = 0; i < (layers.length ?? 0); ++i)
        gl.texSubImage3D(
            gl.TEXTURE_2D_ARRAY,
            0,
            0,
            0,
            i,
            width,
            height,
            1,
            ...clientFormat(gl, format),
            layers[i],
        );
    setNearest(gl, gl.TEXTURE_2D_ARRAY);
    return texture;
}

function clientFormat(gl, format) {
    switch (format) {
        case gl.RGBA8:
            return [gl.RGBA, gl.UNSIGNED_BYTE];
        case gl.RGBA16F:
        case gl.RGBA32F:
            return [gl.RGBA, gl.FLOAT];
        case gl.RG32F:
            return [gl.RG, gl.FLOAT];
        case gl.RGBA32UI:
            return [gl.RGBA_INTEGER, gl.UNSIGNED_INT];
        case gl.RG32UI:
            return [gl.RG_INTEGER, gl.UNSIGNED_INT];
        case gl.R32UI:
            return [gl.RED_INTEGER, gl.UNSIGNED_INT];
        case gl.R16UI:
            return [gl.RED_INTEGER, gl.UNSIGNED_SHORT];
        case gl.RGB9_E5:
            return [gl.RGB, gl.UNSIGNED_INT_5_9_9_9_REV];
        default:
            throw new Error('no client format');
    }
}

// `colors`: textures, or { texture, layer } of arrays.
export function createFramebuffer(gl, colors, depth = null) {
    const framebuffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    colors.forEach((color, i) => {
        const slot = gl.COLOR_ATTACHMENT0 + i;
        if (color.texture) gl.framebufferTextureLayer(gl.FRAMEBUFFER, slot, color.texture, 0, color.layer);
        else gl.framebufferTexture2D(gl.FRAMEBUFFER, slot, gl.TEXTURE_2D, color, 0);
    });
    if (depth) gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, depth, 0);
    gl.drawBuffers(colors.map((_, i) => gl.COLOR_ATTACHMENT0 + i));
    if (gl.checkFramebufferStatus(gl.FRAMEBUFFER) !== gl.FRAMEBUFFER_COMPLETE && !gl.isContextLost())
        throw new Error('this device cannot draw to float textures');
    return framebuffer;
}

/** Whether a context can draw baked light, in a browser that can read it. */
export function isSupported(gl) {
    return (
        typeof DecompressionStream !== 'undefined' &&
        typeof WebGL2RenderingContext !== 'undefined' &&
        gl instanceof WebGL2RenderingContext &&
        gl.getExtension('EXT_color_buffer_float') !== null
    );
}

// What keeps a renderer of three.js from drawing baked light: one sentence, or nothing.
export function lackOf(renderer) {
    if (!renderer.isWebGLRenderer) return 'it needs WebGLRenderer.';
    if (!isSupported(renderer.getContext())) return 'it needs WebGL 2 with float render targets.';
    return renderer.state.buffers.depth.getReversed() ? 'it needs a depth buffer that is not reversed.' : '';
}
