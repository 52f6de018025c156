// The surfaces' corners on the GPU.
// twin: src/gl/scene_upload.cpp.
import { kChartsOffset, kVertexLayout, kVertexWords } from './surfaces.js';

export function createVertices(gl, { vertices, indices }) {
    const vertexArray = gl.createVertexArray(),
        buffers = [gl.createBuffer(), gl.createBuffer()];
    gl.bindVertexArray(vertexArray);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers[0]);
    gl.bufferData(gl.ARRAY_BUFFER, vertices, gl.STATIC_DRAW);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers[1]);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
    kVertexLayout.forEach(([size, offset], location) => {
        gl.enableVertexAttribArray(location);
        gl.vertexAttribPointer(location, size, gl.FLOAT, false, 4 * kVertexWords, 4 * offset);
    });
    const charts = kVertexLayout.length;
    gl.enableVertexAttribArray(charts);
    gl.vertexAttribIPointer(charts, 2, gl.UNSIGNED_INT, 4 * kVertexWords, 4 * kChartsOffset);
    gl.bindVertexArray(null);
    return { vertexArray, buffers };
}
