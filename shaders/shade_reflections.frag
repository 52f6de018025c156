// The light that a pixel's reflection ray brings: what its hit emits and reflects.
// twin: reflectedFromTexels in src/core/bake/irradiance_ray.cpp. Other than there, what hits reflect sharply are PHATexels, and
// the sky itself, instead of walks; hits without texels have no indirect light; shadows at hits are hard.
#include "lib/environment.glsl"
#include "lib/hit_light.glsl"
#include "lib/hit_surface.glsl"
#include "lib/mirror_lobe.glsl"
#ifdef SKY
#include "lib/sky_at_hits.glsl"
#endif
#ifdef GLASS
#include "lib/hit_glass.glsl"
#endif
#include "lib/packed_rays.glsl"
#ifdef TEXELS
#include "lib/random.glsl"
#else
#include "lib/sample_numbers.glsl"
#endif
#include "lib/visible_normal.glsl"
#include "lib/frame.glsl"
#ifndef WITHOUT_PUNCTUAL_LIGHTS
#include "lib/lights.glsl"
#endif

uniform usampler2D hits;    // see lib/packed_rays.glsl
uniform usampler2D places;
uniform sampler2DArray irradiance;  // 0 indirect, 1 area lights; filtered
uniform vec3 brightest;             // radiance that nothing exceeds
uniform float raySpread;            // radians that a ray of a mirror stands for
uniform int ray;
uniform float regularized;          // of the ray's alpha, see below; 0: nothing is
uniform float sharpAtHits;          // rougher lobes, by alpha, take area lights' highlights from glossOfEmitters()

layout(location = 0) out vec4 indirectOut;  // times the ray's weight; the weight
layout(location = 1) out vec4 areaOut;      // the same of emitters and the environment; weight over metres

#ifdef AREA
const int kSources = 2;
#else
const int kSources = 1;
#endif
// Paths by way of two sharp lobes are rare and bright, so that the second is taken at least so rough as a part of the
// first's width, and its light at most so much brighter than the mean: both are biases.
// source: Kaplanyan and Dachsbacher 2013, "Path Space Regularization".
const float kMaxOverMean = 4.0;
#ifdef TEXELS
const int kEmitterPoints = 8;
#else
const int kEmitterPoints = 4;
#endif

// Mirrors' rays are not pooled, and would show one direction of a rough metal in each pixel.
const float kRoughInMirrors = 0.02;
const int kDrawsInMirrors = 8;

// The specular lobes' BRDF, 1/sr.
vec3 evaluateGloss(ViewedBrdf viewed, vec3 towardLight) {
    return towardLight.z > 1e-3 ? evaluateLobes(viewed, towardLight).specular / towardLight.z : vec3(0.0);
}

vec3 arrivingAt(vec2 texel, int source) {
    vec2 size = vec2(textureSize(irradiance, 0).xy);
    return READ(textureLod(irradiance, vec3(texel / size, float(source)), 0.0)).rgb;
}

// source: Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences".
vec2 quasirandom(vec2 first, int i) {
    return fract(first + float(i) * vec2(0.754877666, 0.569840291));
}

// What rough lobes reflect of the area lights for each unit of their irradiance, 1/sr, were all of the emitters visible:
// the mean over the light of some of their points. Negative where none of these shines.
// source of the correction of the ratio's bias: Quenouille 1956, "Notes on Bias in Estimation".
vec3 glossOfEmitters(vec3 position, ViewedBrdf viewed, mat3 worldFromLocal, vec3 u) {
    vec3 sums[2] = vec3[2](vec3(0.0), vec3(0.0));
    vec2 weights = vec2(0.0);
    for (int i = 0; i < kEmitterPoints; ++i) {
        HitEmitter emitter = hitEmitter(chooseEmitter((float(i) + u.z) / float(kEmitterPoints)));
        EmitterSample light = sampleEmitter(emitter, quasirandom(u.xy, i), position);
        vec3 toward = light.direction * worldFromLocal;
        if (light.pdf <= 0.0 || toward.z <= 0.0) continue;
        float weight = luminance(light.radiance) * toward.z / light.pdf;
        sums[i & 1] += weight * evaluateGloss(viewed, toward);
        weights[i & 1] += weight;
    }
    float all = weights.x + weights.y;
    if (all <= 0.0) return vec3(-1.0);
    vec3 mean = (sums[0] + sums[1]) / all;
    if (min(weights.x, weights.y) <= 0.0) return mean;
    return max(2.0 * mean - 0.5 * (sums[0] / weights.x + sums[1] / weights.y), vec3(0.0));
}

// `sharpest`: the least alpha that the lobes are taken with. `draws`: directions of the lobe that is chosen.
vec3 bakedLight(vec3 position, HitSurface s, ViewedBrdf viewed, mat3 worldFromLocal, vec4 u, float sharpest, int draws) {
    if (s.chart == kHitNoChart) return vec3(0.0);
    // One of the lobes, by its albedo.
    float coat = 1.0 - viewed.transmission;
    float coatChance = coat / max(coat + viewed.transmission * maxComponent(viewed.specularAlbedo), 1e-6);
    bool coated = u.w < coatChance;
    float alpha = max(coated ? viewed.brdf.clearcoatAlpha : viewed.brdf.alpha, sharpest);
    vec3 wo = viewed.towardEye, sum = vec3(0.0), means[kSources];
    int drawn = kSources;  // sources whose PHATexels the lobe reflects
    for (int source = 0; source < kSources; ++source) {
        vec3 arriving = arrivingAt(s.texel, source);
        sum += viewed.diffuse * arriving;
        means[source] = arriving / kPi;
        if (source == 1 && emitterCount > 0 && alpha > sharpAtHits) {
            vec3 gloss = glossOfEmitters(position, viewed, worldFromLocal, u.xyz);
            if (gloss.x < 0.0) continue;
            sum += gloss * arriving;
            drawn = 1;
        }
    }
    HitLookup lookup = hitLookup(position, s.texel, s.chart);
#ifdef SKY
    SkyLobes lobes = SkyLobes(viewed, coatChance, float(draws));
    lobes.viewed.brdf.alpha = max(lobes.viewed.brdf.alpha, sharpest);
    lobes.viewed.brdf.clearcoatAlpha = max(lobes.viewed.brdf.clearcoatAlpha, sharpest);
    if (drawn == 2) sum += skyByPoints(lookup, lobes, worldFromLocal, u.xyz);
#endif
    for (int i = 0; i < draws; ++i) {
        vec3 h = squareToVisibleNormal(quasirandom(u.xy, i), wo, alpha), wi = reflect(-wo, h);
        if (wi.z <= 0.0) continue;
        vec3 fresnel = coated ? viewed.brdf.clearcoat / coatChance * schlick(vec3(kClearcoatF0), 1.0, dot(wo, h))
                              : viewed.transmission / (1.0 - coatChance) * schlick(viewed.brdf.f0, viewed.brdf.f90, dot(wo, h));
        vec3 weight = fresnel * visibleNormalWeight(wi, wo, alpha) / float(draws);
        for (int source = 0; source < drawn; ++source) {
            vec3 direction = worldFromLocal * wi, found = phatexelToward(lookup, direction, source == 0 ? 0 : layerCount);
#ifdef SKY
            if (source == 1 && seesSky(lookup, direction, quasirandom(u.yx, i)))
                found = skyByLobe(direction, glossDensity(lobes, wi));
            else if (source == 1 && lookup.seesSky)
                found = vec3(0.0);
#endif
            if (found.x >= 0.0)
                sum += weight * min(found, kMaxOverMean / max(sharpest, 1e-4) * means[source]);
            else if (source == 0)  // no PHATexel looks there where something is near, which hides the emitters
                sum += weight * means[source];
        }
    }
    return sum;
}

// Without them trace_hit_lights.frag adds them.
vec3 punctualLight(vec3 position, HitSurface s, ViewedBrdf viewed, mat3 worldFromLocal) {
    vec3 sum = vec3(0.0);
#ifndef WITHOUT_PUNCTUAL_LIGHTS
    for (int light = 0; light < lightCount; ++light) {
        PunctualSample from = samplePunctual(light, position);
        vec3 reflected = evaluateBrdf(viewed, from.towardLight * worldFromLocal) * from.irradiance;
        if (maxComponent(reflected) > 0.0) sum += reflected * hardShadow(light, position, s.normal);
    }
#endif
    return sum;
}

// Four numbers in [0,1) that say what happens at the hit.
vec4 numbersOf(ivec2 pixel, TracedRay found) {
#ifdef TEXELS
    // The layout that texels take their directions from must not be that of these numbers, too; and a ray that meets what it
    // has met before shall see the same, so that changes of light can be told from noise.
    uvec3 place = floatBitsToUint(found.position);
    return vec4(randomNumbers(place), randomNumbers(~place).x);
#else
    // Two have chosen the ray's direction: of them there is what is finer.
    vec4 u = sampleNumbersOf(ray, pixel, found.count).zwxy;
    return vec4(u.xy, fract(64.0 * u.zw));
#endif
}

// The weight of emission against sampling the emitters, by the power heuristic (Veach 1997).
float emissionWeight(TracedRay ray, HitSurface s) {
    if (s.emitter == 0u) return 1.0;
    HitEmitter emitter = hitEmitter(int(s.emitter) - 1);
    vec3 normal = normalize(cross(emitter.b - emitter.a, emitter.c - emitter.a));
    float cosine = abs(dot(normal, ray.direction));
    float lightPdf = emitter.areaDensity * ray.distance * ray.distance / max(cosine, 1e-6);
    return powerWeight(max(ray.pdf, 1e-6), lightPdf);
}

// The same of the environment.
float skyWeight(TracedRay ray) {
#ifdef SKY
    return powerWeight(max(ray.pdf, 1e-6), environmentPdf(ray.direction));
#else
    return 1.0;
#endif
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    TracedRay found = unpackRay(texelFetch(hits, pixel, 0), texelFetch(places, pixel, 0));
    indirectOut = vec4(0.0);
    areaOut = vec4(0.0);
    if (found.count == 0) return;
    vec3 indirect = vec3(0.0), area = vec3(0.0);
    if (found.triangle < 0) {
        area = skyWeight(found) * environmentRadiance(found.direction);
    } else {
        HitSurface s = hitSurface(found.triangle, found.barycentric, found.backFace, -found.direction,
                                  rayWidth(found, raySpread));
        mat3 worldFromLocal = frameFromNormal(s.normal);
        vec3 eye = -found.direction * worldFromLocal;
        ViewedBrdf viewed = viewedBrdf(s.brdf, eye);
        area = s.emission * emissionWeight(found, s);
        if (reflects(s.brdf)) {
            vec4 u = numbersOf(pixel, found);
            float alpha = rayAlpha(found);
            int draws = alpha < kMinPooledAlpha && s.brdf.alpha > kRoughInMirrors ? kDrawsInMirrors : 1;
            indirect = bakedLight(found.position, s, viewed, worldFromLocal, u, regularized * alpha, draws) +
                       punctualLight(found.position, s, viewed, worldFromLocal);
#ifdef GLASS
            indirect *= reflectedWeight(found.triangle, s, eye);
#endif
        }
    }
    indirect = min(indirect, brightest);
    area = min(area, brightest);
    // A broken vertex or texel must not spread over the picture.
    if (any(isnan(indirect + area)) || any(isinf(indirect + area))) return;
    indirectOut = found.weight * vec4(found.tint * indirect, 1.0);
    areaOut = found.weight * vec4(found.tint * area, 1.0 / max(found.distance, 1e-6));
}
