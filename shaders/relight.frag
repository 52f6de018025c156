// Pass 1, once a frame: the BRDF applied to every PHATexel of the atlas, seen from the eye.
//
// With a = D V F cos / p of the texel's own sample (scalar F), writes a L and a: the display pass divides the
// two sums (ratio estimator), so invalid PHATexels drop out as zeros. The statistics are sum a^2 for the
// effective number of samples and sum a/d for the distance of what is reflected.
// source: Hensley et al. 2003, section 6; the pdf and the normaliser are ours (docs/pipeline.md).
#include "lib/atlas.glsl"
#include "lib/brdf.glsl"
#include "lib/phatexel.glsl"
#include "lib/table.glsl"

uniform usampler2DArray phatexels;     // [layer][y][x] packed, 8 bytes
uniform sampler2D guidePdf;            // see squareToGuidePdf
#ifdef TEXEL_PDF
uniform sampler2DArray texelPdf;       // [layer][y][x] 1/sr, instead of the guides
#endif
uniform sampler2D blockFrames;         // two texels a block: normal, tangent
uniform sampler2D texelPosition;       // world
uniform sampler2D texelNormals;        // octahedral: xy shading normal, zw coat normal; world
uniform sampler2D texelBrdf;           // see texel_material.frag
uniform vec3 eyeWorld;                 // or, for a parallel projection, the direction toward the eye
uniform float eyeAtInfinity;           // 1: parallel projection
uniform int layerCount;
uniform int guideCount;

layout(location = 0) out vec4 lobe;
layout(location = 1) out vec2 lobeStatistics;
#ifdef CLEARCOAT
layout(location = 2) out vec4 coat;
layout(location = 3) out vec2 coatStatistics;
#endif

// a of one lobe; 0 when either direction is below the horizon.
float lobeWeight(vec3 normal, vec3 towardEye, vec3 towardLight, float f0, float f90, float alpha, float pdf) {
    float nDotV = dot(normal, towardEye);
    float nDotL = dot(normal, towardLight);
    if (nDotV <= 0.0 || nDotL <= 0.0) return 0.0;
    vec3 h = normalize(towardEye + towardLight);
    float fresnel = schlick(vec3(f0), f90, dot(towardEye, h)).x;
    return ggxD(min(dot(normal, h), 1.0), alpha) * smithV(nDotL, nDotV, alpha) * fresnel * nDotL / pdf;
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    lobe = vec4(0.0);
    lobeStatistics = vec2(0.0);
#ifdef CLEARCOAT
    coat = vec4(0.0);
    coatStatistics = vec2(0.0);
#endif
    uvec2 chartBlock = texelFetch(tileTable, ivec2(texel.x >> 3, texel.y >> 3), 0).xy;
    if (chartBlock.x == kNoChart) return;

    int block = int(chartBlock.y);
    vec4 brdf = texelFetch(texelBrdf, texel, 0);
    vec4 normals = texelFetch(texelNormals, texel, 0);
    vec3 position = texelFetch(texelPosition, texel, 0).xyz;
    vec3 blockNormal = texelFetch(blockFrames, tableTexel(2 * block), 0).xyz;
    vec3 blockTangent = texelFetch(blockFrames, tableTexel(2 * block + 1), 0).xyz;
    mat3 worldFromBlock = mat3(blockTangent, cross(blockNormal, blockTangent), blockNormal);
    vec3 normal = octahedralToDirection(normals.xy);
    vec3 towardEye = normalize(eyeWorld - position * (1.0 - eyeAtInfinity));

    for (int layer = 0; layer < layerCount; ++layer) {
        Phatexel phatexel = unpackPhatexel(texelFetch(phatexels, ivec3(texel, layer), 0).xy);
        if (!phatexel.valid) continue;
#ifdef TEXEL_PDF
        float pdf = texelFetch(texelPdf, ivec3(texel, layer), 0).r;
#else
        // A direction at the very horizon may come back a hair below it.
        vec3 direction = vec3(phatexel.directionBlock.xy, max(phatexel.directionBlock.z, 0.0));
        float pdf = squareToGuidePdf(guidePdf, guideCount == 1 ? 0 : block, direction);
#endif
        if (!(pdf > 0.0)) continue;
        vec3 towardLight = worldFromBlock * phatexel.directionBlock;
        // A mirror-like lobe's peak may exceed what squares hold in 32 bits: a clamp of the weight, harmless
        // because it bounds numerator and denominator alike.
        float a = min(lobeWeight(normal, towardEye, towardLight, brdf.x, brdf.y, brdf.z, pdf), 1e15);
        lobe += vec4(phatexel.radiance, 1.0) * a;
        lobeStatistics += vec2(a * a, a / phatexel.distance);
#ifdef CLEARCOAT
        if (brdf.w > 0.0) {
            vec3 coatNormal = octahedralToDirection(normals.zw);
            float c = min(lobeWeight(coatNormal, towardEye, towardLight, kClearcoatF0, 1.0, brdf.w, pdf), 1e15);
            coat += vec4(phatexel.radiance, 1.0) * c;
            coatStatistics += vec2(c * c, c / phatexel.distance);
        }
#endif
    }
}
