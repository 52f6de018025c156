// The light of punctual lights that a pixel's reflection ray brings from its hit, with shadows by rays: where there are
// no shadow maps.
// twin: punctualLight in shade_reflections.frag.
#include "lib/bvh.glsl"
#include "lib/frame.glsl"
#include "lib/hit_surface.glsl"
#include "lib/lights.glsl"
#include "lib/packed_rays.glsl"
#include "lib/ray_origin.glsl"
#ifdef GLASS
#include "lib/hit_glass.glsl"
#endif

uniform usampler2D hits;  // see lib/packed_rays.glsl
uniform usampler2D places;
uniform vec3 brightest;   // radiance that nothing exceeds
uniform float raySpread;  // radians that a ray of a mirror stands for
uniform bool hasGlass;    // whether any material is glass

layout(location = 0) out vec4 indirectOut;  // times the ray's weight

// Panes that light passes on its way.
const int kMaxPanes = 4;

// As in shadow maps, glass casts no shadow.
bool isShadowed(vec3 origin, vec3 direction, float meters) {
    for (int i = 0; i < kMaxPanes; ++i) {
        BvhHit hit = traceBvh(origin, direction, meters, !hasGlass);
        if (hit.triangle < 0) return false;
        if (!hasGlass || !isGlass(hit.triangle)) return true;
        float passed = hit.distance + max(1e-4 * hit.distance, originUnitMeters / 65536.0);
        origin += passed * direction;
        meters -= passed;
        if (meters <= 0.0) return false;
    }
    return true;
}

void main() {
    indirectOut = vec4(0.0);
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    TracedRay found = unpackRay(texelFetch(hits, pixel, 0), texelFetch(places, pixel, 0));
    if (found.count == 0 || found.triangle < 0) return;
    vec3 towardEye = -found.direction;
    HitSurface s =
        hitSurface(found.triangle, found.barycentric, found.backFace, towardEye, rayWidth(found, raySpread));
    if (!reflects(s.brdf)) return;
    mat3 worldFromLocal = frameFromNormal(s.normal);
    vec3 eye = towardEye * worldFromLocal;
    ViewedBrdf viewed = viewedBrdf(s.brdf, eye);
    vec3 origin = offsetOrigin(found.position, s.normal, towardEye), sum = vec3(0.0);
    for (int light = 0; light < lightCount; ++light) {
        PunctualSample from = samplePunctual(light, found.position);
        vec3 reflected = evaluateBrdf(viewed, from.towardLight * worldFromLocal) * from.irradiance;
        if (maxComponent(reflected) <= 0.0) continue;
        if (!isShadowed(origin, from.towardLight, from.distance * (1.0 - 1e-4))) sum += reflected;
    }
#ifdef GLASS
    sum *= reflectedWeight(found.triangle, s, eye);
#endif
    sum = min(sum, brightest);
    // A broken vertex must not spread over the picture.
    if (any(isnan(sum)) || any(isinf(sum))) return;
    indirectOut = vec4(found.weight * found.tint * sum, 0.0);
}
