// Makes three.js's materials add the light of the passes at the fragment's position, and rough glass blur what is
// behind it as far as it is away.
import { ShaderChunk } from 'three';
import { chainShader } from './hooks.js';
import { addPhotometry, photometryKey } from './photometry.js';

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

// three.js blurs by roughness alone, as if all were equally far behind the glass. The angles are those of
// shaders/lib/behind.glsl, of which one filtered sample is the half that is nearest to the lobe's middle: within twice
// alpha. The cubic filter of a level has a standard deviation of .645 texels, and half of a Gaussian is within 1.177 of its
// own, so a level's texels have 1 / (.645 * 1.177) of the radius.
const scatter = `
uniform highp sampler2D phatBehindDepth;
// Metres along the view.
float phatMetersAt(vec2 uv) {
    float z = 2.0 * texture2D(phatBehindDepth, uv).r - 1.0;
    if (isOrthographic) return (projectionMatrix[3][2] - z) / projectionMatrix[2][2];
    return projectionMatrix[3][2] / (z + projectionMatrix[2][2]);
}
// Of the lobe's half on the screen, in parts of its height.
float phatRadius(vec2 uv, float alpha, float metersToGlass) {
    float meters = phatMetersAt(uv), behind = max(meters - metersToGlass, 0.0);
    return alpha * projectionMatrix[1][1] * (isOrthographic ? behind : behind / meters);
}
vec4 getTransmissionSample(const in vec2 fragCoord, const in float roughness, const in float ior) {
    // Two interfaces turn light by ior - 1 of what tilts them, a mirror by twice as much.
    float alpha = roughness * roughness * (thickness > 0.0 ? min((ior - 1.0) / sqrt(2.0), 1.0) : 1.0);
    float metersToGlass = -(viewMatrix * vec4(vWorldPosition, 1.0)).z;
    float straight = phatRadius(fragCoord, alpha, metersToGlass), radius = straight;
    vec2 aspect = vec2(transmissionSamplerSize.y / transmissionSamplerSize.x, 1.0);
    for (int i = 0; i < 8; ++i) {
        float angle = 0.7853982 * float(i);
        radius += phatRadius(fragCoord + straight * aspect * vec2(cos(angle), sin(angle)), alpha, metersToGlass);
    }
    float texels = 1.317 * radius / 9.0 * transmissionSamplerSize.y;
    return textureBicubic(transmissionSamplerMap, fragCoord.xy, log2(max(texels, 1.0)));
}
`;
function scattering() {
    return ShaderChunk.transmission_pars_fragment.replace(
        /vec4 getTransmissionSample\([^)]*\) \{[^}]*\}/,
        scatter,
    );
}

// `corner`: of the pictures in what is drawn to, a uniform. Returns the uniforms of the pictures' textures, and
// a function that undoes it.
export function injectLight(material, corner) {
    const uniforms = {
        phatLight: { value: null },
        phatDepth: { value: null },
        phatBehindDepth: { value: null },
        phatCorner: corner,
    };
    const key = () => `phat${photometryKey()}`;
    const undo = chainShader(material, key, (shader) => {
        Object.assign(shader.uniforms, uniforms);
        addPhotometry(shader);
        shader.fragmentShader =
            declarations +
            shader.fragmentShader
                .replace('#include <aomap_fragment>', replaceIndirect)
                .replace('#include <transmission_pars_fragment>', scattering)
                .replace(
                    '#include <opaque_fragment>',
                    'outgoingLight += phatLightHere();\n#include <opaque_fragment>',
                );
    });
    return { uniforms, undo };
}
