// Pictures between the passes, of the frame's size.
// twin: LookupTargets in src/gl/lookup_pass.h, FrameTargets in src/gl/display_pass.h.
import { createFramebuffer, createTexture2D, createTextureArray } from './gl.js';

// `layers`: of the sums, see shaders/lib/sums_out.glsl; `lobeCount`: with clear coats 2. Returns { width, height,
// incident, pooled, pooledTarget, reflectances, baseLobes, coatLobes, opaque, blended }; the last, if requested, like
// `opaque` { depth, light, lobesTarget, incidentTarget, lightTarget }.
export function createTargets(gl, { width, height, layers, lobeCount, hasBlended }) {
    const texture = (format) => createTexture2D(gl, format, width, height);
    const array = () => createTextureArray(gl, gl.RGBA32UI, width, height, layers);
    const target = (sums, depth) => {
        const attachments = Array.from({ length: layers }, (_, layer) => ({ texture: sums, layer }));
        return createFramebuffer(gl, attachments, depth);
    };
    const incident = array();
    const pooled = array();
    const reflectances = texture(gl.RGBA32UI);
    const baseLobes = texture(gl.RGBA32F);
    const coatLobes = lobeCount > 1 ? texture(gl.RGBA32F) : null;
    const lobes = [reflectances, baseLobes, ...(coatLobes ? [coatLobes] : [])];
    const pooledTarget = target(pooled);
    const targets = { width, height, incident, pooled, pooledTarget, reflectances, baseLobes, coatLobes };
    for (const kind of hasBlended ? ['opaque', 'blended'] : ['opaque']) {
        const depth = texture(gl.DEPTH_COMPONENT32F);
        const light = texture(gl.RGBA16F);
        const lightTarget = createFramebuffer(gl, [light], depth);
        const lobesTarget = createFramebuffer(gl, lobes, depth);
        targets[kind] = { depth, light, lobesTarget, incidentTarget: target(incident, depth), lightTarget };
    }
    return targets;
}

export function disposeTargets(gl, targets) {
    const { opaque = {}, blended = {}, ...shared } = targets;
    for (const object of Object.values({ ...shared }).concat(Object.values(opaque), Object.values(blended))) {
        if (object instanceof WebGLTexture) gl.deleteTexture(object);
        else if (object instanceof WebGLFramebuffer) gl.deleteFramebuffer(object);
    }
}
