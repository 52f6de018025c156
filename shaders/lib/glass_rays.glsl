// Rays through glass.
// twin: src/core/scene/glass.cpp; other than there interpolated normals alone say on which side a ray goes on.
#include "lib/bvh.glsl"
#include "lib/frame.glsl"
#include "lib/hit_glass.glsl"
#include "lib/random.glsl"
#include "lib/ray_origin.glsl"
#include "lib/visible_normal.glsl"

// Light that is trapped for longer is lost.
const int kMaxCrossings = 12;

// A ray on its way. At each interface it is transmitted with a probability equal to the transmittance, or stays there.
struct GlassWalk {
    vec3 origin;
    vec3 direction;
    vec3 tint;        // what is left of the light
    vec3 absorption;  // 1/m, where the ray is
    float meters;     // to `origin`
};

// A ray from an interface, along `direction`, that does not meet it again.
vec3 originBeyond(vec3 position, vec3 normal, vec3 direction) {
    vec3 steps = offsetOrigin(position, vec3(1.0), vec3(0.0)) - position;
    return position + maxComponent(steps) / max(abs(dot(normal, direction)), 0.1) * direction;
}

vec3 mirroredAbout(vec3 v, vec3 h) {
    return 2.0 * dot(v, h) * h - v;
}

// About a microfacet (Walter et al. 2007), or about the surface where that does not cross it; `eta`: of the side of `eye`
// over that of the result. Zero at total internal reflection.
vec3 refracted(vec3 eye, vec3 h, float eta) {
    vec3 direction = refract(-eye, h, eta);
    return direction.z < 0.0 ? direction : refract(-eye, vec3(0.0, 0.0, 1.0), eta);
}

// Where light goes on from the inside of a volume: out of it, or reflected.
vec3 directionFromInside(inout GlassWalk walk, HitSurface s, float ior, vec3 eye, vec3 h, float u) {
    float cosine = min(abs(dot(eye, h)), 1.0), sine2 = ior * ior * (1.0 - cosine * cosine);
    // Schlick's formula with the angle outside, so that both directions reflect alike.
    float reflectance = sine2 >= 1.0 ? 1.0 : maxComponent(schlick(s.brdf.f0, s.brdf.f90, sqrt(1.0 - sine2)));
    vec3 local = u < reflectance ? vec3(0.0) : refracted(eye, h, ior);
    if (local != vec3(0.0)) {
        walk.tint *= s.brdf.transmissionColor;
        walk.absorption = vec3(0.0);
        return local;
    }
    local = mirroredAbout(eye, h);
    return local.z > 0.0 ? local : vec3(-eye.xy, eye.z);
}

// Thin glass scatters like its specular lobe, mirrored to the other side (KHR_materials_transmission).
vec3 directionThroughPane(vec3 eye, vec3 h) {
    vec3 reflected = mirroredAbout(eye, h);
    return reflected.z > 0.0 ? vec3(reflected.xy, -reflected.z) : -eye;
}

// Whether the ray goes on from a hit on glass. Where it does not, what the surface reflects counts by the tint over one
// less the probability to be transmitted.
bool passes(inout GlassWalk walk, BvhHit hit) {
    HitGlass glass = hitGlass(hit.triangle);
    HitSurface s = hitSide(hit.triangle, hit.barycentric, hit.backFace, false, -walk.direction, 0.0);
    bool isInside = glass.isVolume && hit.backFace;
    if (isInside) walk.absorption = glass.absorption;
    walk.tint *= exp(-walk.absorption * hit.distance);
    vec3 position = walk.origin + hit.distance * walk.direction;
    vec3 u = randomNumbers(floatBitsToUint(position));
    mat3 worldFromLocal = frameFromNormal(s.normal);
    vec3 eye = -walk.direction * worldFromLocal;
    vec3 h = s.brdf.alpha <= kMinAlpha ? vec3(0.0, 0.0, 1.0) : squareToVisibleNormal(u.xy, eye, s.brdf.alpha), local;
    if (isInside) {
        local = directionFromInside(walk, s, glass.ior, eye, h, u.z);
    } else {
        vec3 passed = transmittanceInto(s, glass, eye);
        float chance = min(maxComponent(passed), 1.0);
        if (u.z >= chance) return false;
        walk.tint *= passed / chance;
        walk.absorption = glass.isVolume ? glass.absorption : vec3(0.0);
        local = glass.isVolume ? refracted(eye, h, 1.0 / glass.ior) : directionThroughPane(eye, h);
    }
    walk.direction = normalize(worldFromLocal * local);
    walk.origin = originBeyond(position, s.normal, walk.direction);
    walk.meters += hit.distance;
    return true;
}

// The surface at which a ray's way through glass ends; a glass that it is not transmitted by may be one. Its distance is
// from the walk's last origin.
BvhHit seeThrough(inout GlassWalk walk, float maxDistance) {
    BvhHit hit;
    for (int i = 0; i < kMaxCrossings; ++i) {
        hit = closestHit(walk.origin, walk.direction, maxDistance);
        if (hit.triangle < 0) return hit;
        if (!isGlass(hit.triangle)) {
            walk.tint *= exp(-walk.absorption * hit.distance);
            return hit;
        }
        if (!passes(walk, hit)) return hit;
    }
    walk.tint = vec3(0.0);
    return hit;
}

// What glass leaves of the light along a straight way of `meters`; nothing, where anything else is in it.
// twin: seeStraight in src/core/scene/glass.h.
vec3 straightTransmittance(vec3 origin, vec3 direction, float meters) {
    vec3 left = vec3(1.0), absorption = vec3(0.0);
    float entryReflectance = 0.0;
    for (int i = 0; i < kMaxCrossings; ++i) {
        BvhHit hit = closestHit(origin, direction, meters);
        if (hit.triangle < 0) return left * exp(-absorption * meters);
        if (!isGlass(hit.triangle)) return vec3(0.0);
        HitGlass glass = hitGlass(hit.triangle);
        HitSurface s = hitSide(hit.triangle, hit.barycentric, hit.backFace, false, -direction, 0.0);
        vec3 eye = -direction * frameFromNormal(s.normal);
        float reflectance = maxComponent(specularAlbedo(s.brdf.f0, s.brdf.f90, s.brdf.alpha, eye.z));
        if (glass.isVolume && hit.backFace) {
            // Between parallel planes the refracted ray is shorter, and what is reflected back and forth leaves in the end.
            float way = hit.distance * eye.z / max(refractedCosine(eye.z, glass.ior), 1e-3);
            vec3 inside = exp(-glass.absorption * way);
            left *= interfaceTransmittance(s.brdf, eye) * inside /
                    (1.0 - entryReflectance * reflectance * inside * inside);
            absorption = vec3(0.0);
            entryReflectance = 0.0;
        } else {
            left *= transmittanceInto(s, glass, eye);
            absorption = glass.isVolume ? glass.absorption : vec3(0.0);
            entryReflectance = glass.isVolume ? reflectance : 0.0;
        }
        vec3 beyond = originBeyond(origin + hit.distance * direction, s.normal, direction);
        meters -= dot(beyond - origin, direction);
        origin = beyond;
        if (meters <= 0.0) return left;
    }
    return vec3(0.0);
}
