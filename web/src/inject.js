// Makes three.js's materials add the light of the passes at the fragment's position.

// The passes draw each pixel once; at edges, where multisampling shades two surfaces, the neighbour that is
// nearest in depth is the fragment's own surface.
const declarations = `
uniform highp sampler2D phatLight;
uniform highp sampler2D phatDepth;
uniform ivec2 phatCorner;
vec3 phatLightHere() {
    ivec2 last = textureSize(phatLight, 0) - 1;
    ivec2 here = clamp(ivec2(gl_FragCoord.xy) - phatCorner, ivec2(0), last), best = here;
    float z = gl_FragCoord.z, least = abs(texelFetch(phatDepth, here, 0).r - z);
    if (least > fwidth(z)) {
        for (int i = 0; i < 4; ++i) {
            ivec2 at = clamp(here + (i < 2 ? ivec2(2 * i - 1, 0) : ivec2(0, 2 * i - 5)), ivec2(0), last);
            float apart = abs(texelFetch(phatDepth, at, 0).r - z);
            if (apart < least) {
                least = apart;
                best = at;
            }
        }
    }
    return texelFetch(phatLight, best, 0).rgb;
}
`;

// The bake replaces ambient, hemisphere and environment light.
const replaceIndirect = `#include <aomap_fragment>
reflectedLight.indirectDiffuse = vec3(0.0);
reflectedLight.indirectSpecular = vec3(0.0);
#ifdef USE_CLEARCOAT
clearcoatSpecularIndirect = vec3(0.0);
#endif
`;

// `corner`: of the pictures in what is drawn to, a uniform. Returns the uniforms phatLight and phatDepth, and
// a function that undoes it.
export function injectLight(material, corner) {
    const uniforms = { phatLight: { value: null }, phatDepth: { value: null }, phatCorner: corner };
    const { onBeforeCompile, customProgramCacheKey } = material;
    material.onBeforeCompile = function (shader, renderer) {
        onBeforeCompile.call(this, shader, renderer);
        Object.assign(shader.uniforms, uniforms);
        shader.fragmentShader =
            declarations +
            shader.fragmentShader
                .replace('#include <aomap_fragment>', replaceIndirect)
                .replace(
                    '#include <opaque_fragment>',
                    'outgoingLight += phatLightHere();\n#include <opaque_fragment>',
                );
    };
    material.customProgramCacheKey = function () {
        return `phat ${customProgramCacheKey.call(this)}`;
    };
    material.needsUpdate = true;
    const undo = () => {
        Object.assign(material, { onBeforeCompile, customProgramCacheKey });
        material.needsUpdate = true;
    };
    return { uniforms, undo };
}
