// Light that a pixel's lobe receives from one sampled point of the emitters, or with SKY of the environment: small ones,
// which its reflection rays would seldom meet. source: estimateByLightSample in src/core/render/traced_reflections.cpp; the weights are those of
// emissionWeight and skyWeight in shade_reflections.frag.
#include "lib/bvh.glsl"
#include "lib/hit_surface.glsl"
#include "lib/lobe_pixels.glsl"
#include "lib/mirror_lobe.glsl"
#include "lib/packed_rays.glsl"
#include "lib/ray_origin.glsl"
#include "lib/reflection_guides.glsl"
#include "lib/sample_numbers.glsl"
#include "lib/scalar_lobe.glsl"
#ifdef SKY
#include "lib/environment_samples.glsl"
#endif
#ifdef GLASS
#include "lib/glass_rays.glsl"
#endif

uniform usampler2D points;     // see lobes.frag
uniform usampler2D guides;
uniform sampler2D rayWeights;  // a: the sum of the weights of the pixel's rays
uniform vec3 eyeWorld;
uniform float eyeAtInfinity;
uniform vec3 brightest;
uniform int lobe;
uniform int lightSample;
uniform int lightSamples;      // of a pixel, a power of two

layout(location = 0) out vec4 areaOut;  // times those weights

void main() {
    areaOut = vec4(0.0);
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    if (int(texelFetch(guides, pixel, 0).z >> 24) == 0) return;
    vec4 u = sampleNumbersOf(lightSample, pixel, lightSamples);
    PixelLobe l = pixelLobe(pixel, lobe);
    if (l.alpha < kMinPooledAlpha) return;
    uvec4 point = texelFetch(points, pixel, 0);
    vec3 position = uintBitsToFloat(point.xyz), normalGeometric = octahedralToDirection(unpackSnorm2x16(point.w));
#ifdef SKY
    EmitterSample light = sampleEnvironment(u);
#else
    EmitterSample light = sampleEmitter(hitEmitter(chooseEmitter(u.z)), u.xy, position);
#endif
    if (light.pdf <= 0.0 || dot(light.direction, normalGeometric) <= 0.0) return;

    mat3 worldFromLocal = frameFromNormal(l.normal);
    vec3 towardEye = normalize(eyeWorld - position * (1.0 - eyeAtInfinity));
    vec3 wo = towardEye * worldFromLocal, wi = light.direction * worldFromLocal;
    if (wo.z <= 0.0 || wi.z <= 0.0) return;
    float value = lobeValueLocal(ScalarLobe(l.normal, l.f0, l.f90, l.alpha), wo, wi);
    float lobePdf = smithG1(wo.z, l.alpha) * ggxD(normalize(wo + wi).z, l.alpha) / (4.0 * wo.z);
    float weight = powerWeight(light.pdf, min(lobePdf, kMaxPdf));
    float albedo = specularAlbedo(vec3(l.f0), l.f90, l.alpha, wo.z).x;
    // Below this weight no emitter is bright enough to be visible, and the ray is saved.
    if (value <= 0.0 || weight < 1e-6 || albedo <= 0.0) return;
    vec3 origin = offsetOrigin(position, normalGeometric, towardEye);
    float meters = light.meters * (1.0 - 1e-4);
#ifdef GLASS
    light.radiance *= straightTransmittance(origin, light.direction, meters);
    if (maxComponent(light.radiance) <= 0.0) return;
#else
    if (anyHit(origin, light.direction, meters)) return;
#endif
    vec3 arriving = min(value * weight / light.pdf / albedo * light.radiance, brightest);
    areaOut = vec4(texelFetch(rayWeights, pixel, 0).a / float(lightSamples) * arriving, 0.0);
}
