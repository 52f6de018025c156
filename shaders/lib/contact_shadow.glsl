// What things that were not in the bake keep of its light from its surfaces: contact shadows. As if the light were the
// same all around and the ellipsoids that stand for a thing lay apart, which are approximations.
#include "lib/hemisphere_map.glsl"

// twin: kMaxOccluders in src/core/scene/occluders.h, web/src/occluders.js.
const int kMaxOccluders = 32;

// Of each the centre, then xx, yy, zz, xy, xz and yz of the squared area of its shadow.
// twin: rowsOf in src/core/scene/occluders.h.
uniform vec4 occluders[3 * kMaxOccluders];
uniform int occluderCount;

// Of the irradiance under a uniform hemisphere, the part that a sphere keeps away: exact. source: Snyder 1996,
// in the form of Quilez 2006.
// twin: sphereOcclusion in src/core/scene/occluders.h.
float sphereOcclusion(vec3 towardCenter, float radius, vec3 normal) {
    float distance = length(towardCenter), relative = distance / radius;
    float squared = relative * relative;
    if (!(squared > 1.0)) return 1.0;
    float cosine = dot(normal, towardCenter) / distance;
    float cut = 1.0 - squared * cosine * cosine;
    if (!(cut > 0.0)) return max(cosine, 0.0) / squared;
    // The horizon cuts it.
    float outside = squared - 1.0;
    float angle = acos(clamp(-cosine * sqrt(outside / (1.0 - cosine * cosine)), -1.0, 1.0));
    float part = (cosine * angle - sqrt(cut * outside)) / squared + atan(sqrt(cut / outside));
    return clamp(part / kPi, 0.0, 1.0);
}

// The same of the sphere that has an occluder's shadow as seen from there. twin: occlusionBy in
// src/core/scene/occluders.h.
float occlusionBy(int occluder, vec3 position, vec3 normal) {
    vec4 first = occluders[3 * occluder], second = occluders[3 * occluder + 1];
    vec3 toward = first.xyz - position;
    vec3 d = toward / max(length(toward), 1e-20);
    float squared = first.w * d.x * d.x + second.x * d.y * d.y + second.y * d.z * d.z +
                    2.0 * (second.z * d.x * d.y + second.w * d.x * d.z + occluders[3 * occluder + 2].x * d.y * d.z);
    return squared > 0.0 ? sphereOcclusion(toward, sqrt(sqrt(squared) / kPi), normal) : 0.0;
}

// What is left of the irradiance of a surface.
float unoccludedByThings(vec3 position, vec3 normal) {
    float left = 1.0;
    for (int i = 0; i < occluderCount; ++i) left *= 1.0 - occlusionBy(i, position, normal);
    return left;
}
