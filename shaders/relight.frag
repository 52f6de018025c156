// Pass 1, once a frame: the BRDF applied to every PHATexel of the atlas, for the eye's position.
//
// With a = D V F cos / p of the texel's own sample (scalar F), the display pass divides sum a L by sum w and
// multiplies by the lobe's albedo; invalid PHATexels drop out as zeros.
//  - Indirect light: w = a, the ratio estimator: a convex combination of real radiances.
//  - Area lights (AREA): w is a's expectation, the albedo, where they are small. Their samples crowd toward the
//    lights, where a is small; a neighbourhood that happens to miss the few large a would show the lights as
//    fireflies. Where light comes from all around, a's noise is the numerator's own and w = a removes it. Both are
//    consistent, so the transition between them changes noise alone.
// The statistics tell radius.frag how many samples a lobe has here and how far away is what it reflects.
// source: Hensley et al. 2003, section 6; the pdf and the normalisers are ours (docs/reference.md).
#include "lib/atlas.glsl"
#include "lib/lit_fraction.glsl"
#include "lib/phatexel.glsl"
#include "lib/scalar_lobe.glsl"
#include "lib/tile_patch.glsl"

uniform usampler2DArray phatexels;     // [layer][y][x] packed, 8 bytes
uniform sampler2D guidePdf;            // see squareToGuidePdf
uniform sampler2D tileLight;           // a: fraction of the solid angle with area lights
#ifdef TEXEL_PDF
uniform sampler2DArray texelPdf;       // [layer][y][x] 1/sr, instead of the guides
#endif
uniform usampler2D tilePatches;        // see lib/tile_patch.glsl
uniform sampler2D texelNormals;        // octahedral: xy shading normal, zw coat normal; world
uniform sampler2D texelBrdf;           // see texel_material.frag
uniform vec3 eyeWorld;                 // or, for a parallel projection, the direction toward the eye
uniform float eyeAtInfinity;           // 1: parallel projection
uniform int firstLayer;                // of this source
uniform int layerCount;
uniform int guideCount;

layout(location = 0) out vec4 lobe;            // sum a L, sum w
layout(location = 1) out vec2 lobeStatistics;  // see addSample; sum a / distance
#ifdef CLEARCOAT
layout(location = 2) out vec4 coat;
layout(location = 3) out vec2 coatStatistics;
#endif

// A texel of the atlas and its direction toward the eye.
struct RelitTexel {
    ivec2 texel;
    int block;
    mat3 worldFromBlock;
    vec3 towardEye;
    float ratioWeight;  // 1 where the samples' own weight is the denominator, 0 where it is their expectation
};

float densityAt(RelitTexel t, vec3 directionBlock, int layer) {
#ifdef TEXEL_PDF
    return texelFetch(texelPdf, ivec3(t.texel, layer), 0).r;
#else
    return squareToGuidePdf(guidePdf, guideCount == 1 ? 0 : t.block, directionBlock);
#endif
}

// How many of a texel's samples may be expected under the lobe: the density at its mirror direction times the
// lobe's solid angle. Counting the samples that are there would not do: where none hit the lobe, its tails look
// like many. The solid angle is 1 / (integral of D^2), 3 pi alpha^2 for small alpha, times d(light)/d(half) = 4 v.h.
float expectedSamples(ScalarLobe l, RelitTexel t, int layer) {
    float nDotV = dot(l.normalWorld, t.towardEye);
    if (nDotV <= 0.0) return 0.0;
    vec3 mirror = (2.0 * nDotV * l.normalWorld - t.towardEye) * t.worldFromBlock;
    mirror = normalize(vec3(mirror.xy, max(mirror.z, 0.0)));
    float solidAngle = min(12.0 * kPi * l.alpha * l.alpha * nDotV, kPi);
    return densityAt(t, mirror, layer) * solidAngle;
}

// Fewer samples a texel than this, and even the widest cone (2/3 pi R^2 texels) holds less than 24 of them.
const float kMinSamplesPerTexel = 24.0 / (2.0 / 3.0 * kPi * 24.0 * 24.0);
const float kMaxAlphaScale = 20.0;

float ratioWeightOf(ivec2 texel) {
#ifdef AREA
    return smoothstep(kMinLitFraction, kMaxLitFraction, texelFetch(tileLight, texel >> 3, 0).a);
#else
    return 1.0;
#endif
}

// The roughness clamp, a bias: the alpha of a lobe too sharp for the texels to hold samples of it grows, at most to
// twenty times its own, because a blurred reflection disturbs less than the discs of single samples and than charts
// that differ. Measured on gallery's curved metals: MAE/mean .456, .434 and .431 with 6, 10 and 20. Asking for as many
// samples in narrower cones helps them further, but blurs cornell-glossy's metals (.270 to .361).
void clampRoughness(inout ScalarLobe l, inout float expected, float ratioWeight) {
    float lack = kMinSamplesPerTexel / max(expected, 1e-20);
    float alphaScale = pow(clamp(sqrt(lack), 1.0, kMaxAlphaScale), ratioWeight);
    l.alpha = min(l.alpha * alphaScale, max(l.alpha, 1.0));
    expected *= alphaScale * alphaScale;
}

// `statistics`: see radius.frag; the number of samples, or the sum of their squares where they are counted.
void addSample(ScalarLobe l, RelitTexel t, Phatexel phatexel, int layer, inout vec4 sums, inout vec2 statistics) {
    float expected = 0.0;
    if (t.ratioWeight > 0.0) {
        expected = expectedSamples(l, t, layer);
        clampRoughness(l, expected, t.ratioWeight);
    }
    // A mirror-like lobe's peak may exceed what squares hold in 32 bits: a clamp.
    float a = min(lobeValueWorld(l, t.towardEye, t.worldFromBlock * phatexel.directionBlock) / phatexel.pdf, 1e12);
    float w = a, count = expected;
    if (t.ratioWeight < 1.0) {
        float nDotV = max(dot(l.normalWorld, t.towardEye), 0.0);
        w = mix(specularAlbedo(vec3(l.f0), l.f90, l.alpha, nDotV).x, a, t.ratioWeight);
    }
    if (t.ratioWeight < kCountsExpected) {
        float value = a * luminance(phatexel.radiance);
        count = value * value;
    }
    sums += vec4(phatexel.radiance * a, w);
    statistics += vec2(count, a / phatexel.distance);
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    lobe = vec4(0.0);
    lobeStatistics = vec2(0.0);
#ifdef CLEARCOAT
    coat = vec4(0.0);
    coatStatistics = vec2(0.0);
#endif
    ivec2 tile = texel >> 3;
    uvec2 chartBlock = texelFetch(tileTable, tile, 0).xy;
    if (chartBlock.x == kNoChart) return;

    vec4 brdf = texelFetch(texelBrdf, texel, 0);
    vec4 normals = texelFetch(texelNormals, texel, 0);
    TilePatch tilePatch = tilePatchAt(tilePatches, tile, texelSizeOfTile(tile));
    vec3 position = positionOnPatch(tilePatch, vec2(texel & 7) - 3.5);
    vec3 towardEye = normalize(eyeWorld - position * (1.0 - eyeAtInfinity));
    RelitTexel t = RelitTexel(texel, int(chartBlock.y), tilePatch.worldFromBlock, towardEye, ratioWeightOf(texel));
    ScalarLobe base = ScalarLobe(octahedralToDirection(normals.xy), brdf.x, brdf.y, brdf.z);
    for (int layer = 0; layer < layerCount; ++layer) {
        Phatexel phatexel = unpackPhatexel(texelFetch(phatexels, ivec3(texel, firstLayer + layer), 0).xy);
        if (!phatexel.valid) continue;
        phatexel.pdf = densityAt(t, phatexel.directionBlock, layer);
        if (!(phatexel.pdf > 0.0)) continue;
        addSample(base, t, phatexel, layer, lobe, lobeStatistics);
#ifdef CLEARCOAT
        if (brdf.w > 0.0) {
            ScalarLobe coatLobe = ScalarLobe(octahedralToDirection(normals.zw), kClearcoatF0, 1.0, brdf.w);
            addSample(coatLobe, t, phatexel, layer, coat, coatStatistics);
        }
#endif
    }
}
