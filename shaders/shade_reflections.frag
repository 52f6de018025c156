// The light that a pixel's reflection ray brings: what its hit emits and reflects.
// twin: reflectedFromTexels in src/core/bake/irradiance_ray.cpp. Other than there, hits have no normal maps; what they
// reflect sharply is one PHATexel instead of walks; hits without texels have no indirect light; shadows at hits are hard.
#include "lib/hit_light.glsl"
#include "lib/hit_surface.glsl"
#include "lib/packed_rays.glsl"
#include "lib/sample_numbers.glsl"
#include "lib/visible_normal.glsl"
#include "lib/frame.glsl"
#ifndef WITHOUT_PUNCTUAL_LIGHTS
#include "lib/lights.glsl"
#endif

uniform usampler2D hits;    // see lib/packed_rays.glsl
uniform usampler2D places;
uniform sampler2DArray irradiance;  // 0 indirect, 1 area lights; filtered
uniform sampler2D environment;      // see background.frag
uniform float turn;
uniform vec3 brightest;             // radiance that nothing exceeds
uniform float raySpread;            // radians that a ray of a mirror stands for
uniform int ray;
uniform float regularized;          // of the ray's alpha, see below; 0: nothing is

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
// Rougher lobes at hits take area lights' highlights from the irradiance and the direction of an emitter.
const float kSharpAtHits = 0.15;

// The specular lobes' BRDF, 1/sr.
vec3 evaluateGloss(ViewedBrdf viewed, vec3 towardLight) {
    return towardLight.z > 1e-3 ? evaluateLobes(viewed, towardLight).specular / towardLight.z : vec3(0.0);
}

vec3 environmentRadiance(vec3 d) {
    vec2 uv = vec2(atan(d.z, d.x) / (2.0 * kPi) + 0.5 - turn, acos(clamp(d.y, -1.0, 1.0)) / kPi);
    return textureLod(environment, uv, 0.0).rgb;
}

vec3 arrivingAt(vec2 texel, int source) {
    vec2 size = vec2(textureSize(irradiance, 0).xy);
    return READ(textureLod(irradiance, vec3(texel / size, float(source)), 0.0)).rgb;
}

vec3 bakedLight(vec3 position, HitSurface s, ViewedBrdf viewed, mat3 worldFromLocal, vec4 u,
                float sharpest) {
    if (s.chart == kHitNoChart) return vec3(0.0);
    vec3 albedo = viewed.transmission * viewed.specularAlbedo, coat = vec3(1.0 - viewed.transmission);
    vec3 sum = vec3(0.0);
    bool coated = u.x * maxComponent(albedo + coat) < coat.x;
    float alpha = max(coated ? viewed.brdf.clearcoatAlpha : viewed.brdf.alpha, sharpest);
    vec3 wi = reflect(-viewed.towardEye, squareToVisibleNormal(u.xy, viewed.towardEye, alpha));
    vec3 direction = worldFromLocal * wi;
    HitLookup lookup = hitLookup(position, s.texel, s.chart);
    for (int source = 0; source < kSources; ++source) {
        vec3 arriving = arrivingAt(s.texel, source);
        sum += viewed.diffuse * arriving;
        if (source == 1 && emitterCount > 0 && alpha > kSharpAtHits) {
            // One direction toward the emitters stands for all of their light.
            vec3 toward = pointOnEmitter(hitEmitter(chooseEmitter(u.z)), u.xy) - position;
            sum += evaluateGloss(viewed, normalize(toward) * worldFromLocal) * arriving;
            continue;
        }
        if (wi.z <= 0.0) continue;
        vec3 found = phatexelToward(lookup, direction, source == 0 ? 0 : layerCount);
        vec3 mean = arriving / kPi;
        sum += (albedo + coat) * (found.x < 0.0 ? mean : min(found, kMaxOverMean / max(sharpest, 1e-4) * mean));
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

// The weight of emission against sampling the emitters, by the power heuristic (Veach 1997).
float emissionWeight(TracedRay ray, HitSurface s) {
    if (s.emitter == 0u) return 1.0;
    HitEmitter emitter = hitEmitter(int(s.emitter) - 1);
    vec3 normal = normalize(cross(emitter.b - emitter.a, emitter.c - emitter.a));
    float cosine = abs(dot(normal, ray.direction));
    float lightPdf = emitter.areaDensity * ray.distance * ray.distance / max(cosine, 1e-6);
    return powerWeight(max(ray.pdf, 1e-6), lightPdf);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    TracedRay found = unpackRay(texelFetch(hits, pixel, 0), texelFetch(places, pixel, 0));
    indirectOut = vec4(0.0);
    areaOut = vec4(0.0);
    if (found.count == 0) return;
    vec3 indirect = vec3(0.0), area = vec3(0.0);
    if (found.triangle < 0) {
        area = environmentRadiance(found.direction);
    } else {
        HitSurface s = hitSurface(found.triangle, found.barycentric, found.backFace, -found.direction,
                                  rayWidth(found, raySpread));
        mat3 worldFromLocal = frameFromNormal(s.normal);
        ViewedBrdf viewed = viewedBrdf(s.brdf, -found.direction * worldFromLocal);
        area = s.emission * emissionWeight(found, s);
        if (reflects(s.brdf)) {
            vec4 u = sampleNumbersOf(ray, pixel, found.count).zwxy;
            indirect = bakedLight(found.position, s, viewed, worldFromLocal, u, regularized * rayAlpha(found)) +
                       punctualLight(found.position, s, viewed, worldFromLocal);
        }
    }
    indirect = min(indirect, brightest);
    area = min(area, brightest);
    // A broken vertex or texel must not spread over the picture.
    if (any(isnan(indirect + area)) || any(isinf(indirect + area))) return;
    indirectOut = found.weight * vec4(indirect, 1.0);
    areaOut = found.weight * vec4(area, 1.0 / max(found.distance, 1e-6));
}
