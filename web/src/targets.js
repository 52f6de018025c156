// Pictures between the passes, of the frame's size.
// twin: LookupTargets in src/gl/lookup_pass.h, FrameTargets in src/gl/display_pass.h, RayTargets in src/gl/ray_pass.h.
import { createFramebuffer, createTexture2D, createTextureArray } from './gl.js';

// `layers`: of the sums, see shaders/lib/sums_out.glsl; `lobeCount`: with clear coats 2. Returns { width, height,
// incident, pooled, pooledTarget, reflectances, baseLobes, coatLobes, opaque, blended }; the last, if requested, like
// `opaque` { depth, light, lobesTarget, incidentTarget, lightTarget }; and `rays`, if `traces`, see createRayTargets.
export function createTargets(gl, { width, height, layers, lobeCount, hasBlended, traces }) {
    const texture = (format) => createTexture2D(gl, format, width, height);
    const array = (count) => createTextureArray(gl, gl.RGBA32UI, width, height, count);
    const target = (sums, depth) => {
        const attachments = Array.from({ length: layers }, (_, layer) => ({ texture: sums, layer }));
        return createFramebuffer(gl, attachments, depth);
    };
    const incident = array(layers + (traces ? 2 * lobeCount : 0));
    const pooled = array(layers);
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
    if (traces) targets.rays = createRayTargets(gl, texture, { targets, lobes, layers, lobeCount });
    return targets;
}

// Between the passes of the rays; what they hit is overwritten by their means, when they are shaded.
function createRayTargets(gl, texture, { targets, lobes, layers, lobeCount }) {
    const { incident, opaque } = targets,
        [points, guides, hits, places] = Array.from({ length: 4 }, () => texture(gl.RGBA32UI)),
        [indirectSums, areaSums] = [0, 1].map(() => texture(gl.RGBA16F));
    const counts = texture(gl.DEPTH_COMPONENT16); // see shaders/reflection_guides.frag
    const incidentTargets = Array.from({ length: lobeCount }, (_, lobe) => {
        const first = layers + 2 * lobe;
        return createFramebuffer(
            gl,
            [first, first + 1].map((layer) => ({ texture: incident, layer })),
            counts,
        );
    });
    return {
        points,
        guides,
        hits,
        places,
        indirectSums,
        areaSums,
        counts,
        lobesTarget: createFramebuffer(gl, [...lobes, points], opaque.depth),
        guidesTarget: createFramebuffer(gl, [guides], counts),
        raysTarget: createFramebuffer(gl, [hits, places], counts),
        sumsTarget: createFramebuffer(gl, [indirectSums, areaSums], counts),
        indirectTarget: createFramebuffer(gl, [indirectSums], counts),
        areaTarget: createFramebuffer(gl, [areaSums], counts),
        meansTarget: createFramebuffer(gl, [hits], counts),
        pooledTarget: createFramebuffer(gl, [places], counts),
        incidentTargets,
    };
}

export function disposeTargets(gl, targets) {
    const { opaque, blended, rays, ...shared } = targets;
    const all = [shared, opaque, blended, rays, rays?.incidentTargets].flatMap((of) => Object.values(of ?? {}));
    for (const object of all) {
        if (object instanceof WebGLTexture) gl.deleteTexture(object);
        else if (object instanceof WebGLFramebuffer) gl.deleteFramebuffer(object);
    }
}
