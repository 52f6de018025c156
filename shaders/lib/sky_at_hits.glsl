// What glossy lobes at hits reflect of the sky. Depth probes say where it is seen. PHATexels, most of which look at the sun,
// are too few elsewhere: one that is found for a direction may look many degrees past it.
#include "lib/environment.glsl"
#include "lib/hit_light.glsl"
#include "lib/hit_surface.glsl"

// twin: src/gl/environment_upload.h, web/src/environment_upload.js.
const int kSkyPoints = 32;
const int kSkyPointsAtHits = 2;

uniform vec4 skyPoints[kSkyPoints];  // directions by how bright the sky is; their density, 1/sr. All 0: none is sampled
uniform vec4 skyPointRadiance[kSkyPoints];

// `u`: in [0,1), hides the cells of the depth probe.
bool seesSky(inout HitLookup lookup, vec3 direction, vec2 u) {
    return distanceAlong(lookup.probe, direction, u - 0.5) >= 0.99 * kHorizon * unitMeters;
}

struct SkyLobes {
    ViewedBrdf viewed;
    float coatChance;  // that the coat's is taken
    float draws;       // directions of the one that is taken
};

// Directions for each steradian around `wi`, which is local.
float glossDensity(SkyLobes lobes, vec3 wi) {
    Brdf brdf = lobes.viewed.brdf;
    vec3 wo = lobes.viewed.towardEye, h = normalize(wo + wi);
    float base = smithG1(wo.z, brdf.alpha) * ggxD(h.z, brdf.alpha);
    float coat = smithG1(wo.z, brdf.clearcoatAlpha) * ggxD(h.z, brdf.clearcoatAlpha);
    return lobes.draws * max(mix(base, coat, lobes.coatChance) / (4.0 * wo.z), 1e-6);
}

// In a direction of the lobes: what skyPoints do not bring.
vec3 skyByLobe(vec3 direction, float density) {
    return powerWeight(density, float(kSkyPointsAtHits) * environmentPdf(direction)) * environmentRadiance(direction);
}

// The rest. `u`: in [0,1).
vec3 skyByPoints(inout HitLookup lookup, SkyLobes lobes, mat3 worldFromLocal, vec3 u) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < kSkyPointsAtHits; ++i) {
        float choice = (float(i) + u.z) / float(kSkyPointsAtHits);
        int chosen = min(int(choice * float(kSkyPoints)), kSkyPoints - 1);
        vec4 point = skyPoints[chosen];
        vec3 wi = point.xyz * worldFromLocal;
        if (wi.z <= 1e-3) continue;
        float own = float(kSkyPointsAtHits) * point.w;
        vec3 reflected = powerWeight(own, glossDensity(lobes, wi)) / own * evaluateLobes(lobes.viewed, wi).specular;
        if (maxComponent(reflected) <= 0.0) continue;
        if (seesSky(lookup, point.xyz, u.xy)) sum += reflected * skyPointRadiance[chosen].rgb;
    }
    return sum;
}
