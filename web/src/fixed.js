// Resources of the passes that do not depend on the room: WebGL's state, and constant textures.
import { ShaderProgram, createFramebuffer, createTexture2D } from './gl.js';

const kSplitSumSize = 64; // twin: src/core/scene/brdf.h

// WebGL state that three.js may have left enabled.
export function resetState(gl, width, height) {
    for (const switched of [
        gl.BLEND,
        gl.SCISSOR_TEST,
        gl.STENCIL_TEST,
        gl.CULL_FACE,
        gl.DEPTH_TEST,
        gl.POLYGON_OFFSET_FILL,
        gl.SAMPLE_ALPHA_TO_COVERAGE,
        gl.RASTERIZER_DISCARD,
    ])
        gl.disable(switched);
    gl.colorMask(true, true, true, true);
    gl.depthMask(true);
    gl.frontFace(gl.CCW);
    gl.cullFace(gl.BACK);
    gl.viewport(0, 0, width, height);
}

// As uploads of typed arrays want it; three.js leaves it as its last image wanted it.
export function prepareUploads(gl) {
    gl.bindBuffer(gl.PIXEL_UNPACK_BUFFER, null);
    for (const flag of [gl.UNPACK_FLIP_Y_WEBGL, gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL]) gl.pixelStorei(flag, false);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
}

export function whiteTexture(gl) {
    return createTexture2D(gl, gl.RGBA8, 1, 1, new Uint8Array([255, 255, 255, 255]));
}

// 64x64 numbers that a CPU would need half a second for.
export function drawSplitSum(gl) {
    const texture = createTexture2D(gl, gl.RGBA32F, kSplitSumSize, kSplitSumSize),
        framebuffer = createFramebuffer(gl, [texture]),
        program = new ShaderProgram(gl, 'fullscreen.vert', 'split_sum.frag'),
        noVertices = gl.createVertexArray();
    resetState(gl, kSplitSumSize, kSplitSumSize);
    program.use();
    program.set('size', kSplitSumSize);
    gl.bindVertexArray(noVertices);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindVertexArray(null);
    gl.deleteVertexArray(noVertices);
    gl.deleteFramebuffer(framebuffer);
    program.dispose();
    return texture;
}
