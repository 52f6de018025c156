// Glass at a ray's hit.
// twin: src/core/scene/glass.cpp; src/gl/hit_tables.cpp writes the tables.
#include "lib/hit_surface.glsl"

struct HitGlass {
    bool isVolume;    // else a pane
    float thickness;  // metres, of a pane
    vec3 absorption;  // 1/m
    float ior;
};

HitGlass hitGlass(int triangle) {
    int first = hitFirstTriangle + kHitTriangleTexels * triangle;
    uint material = hitTexel(first + 2).w;
    vec4 m = uintBitsToFloat(hitTexel(kHitMaterialTexels * int(material & kHitMaterial) + 4));
    return HitGlass((material & kHitVolume) != 0u, unpackHalf2x16(hitTexel(first + 4).w).y, m.xyz, max(m.w, 1.0));
}

// Cosine on the inner side of an interface (Snell's law).
float refractedCosine(float cosine, float ior) {
    return sqrt(max(1.0 - (1.0 - cosine * cosine) / (ior * ior), 0.0));
}

// What passes a pane, or goes into a volume. `eye`: local.
vec3 transmittanceInto(HitSurface s, HitGlass glass, vec3 eye) {
    vec3 passed = interfaceTransmittance(s.brdf, eye);
    if (glass.isVolume) return passed;
    return passed * exp(-glass.absorption * glass.thickness / max(refractedCosine(eye.z, glass.ior), 1e-3));
}

// What a surface's light counts by: glass that a ray ends on was not passed by chance. `eye`: local.
float reflectedWeight(int triangle, HitSurface s, vec3 eye) {
    if (!isGlass(triangle)) return 1.0;
    return 1.0 / max(1.0 - maxComponent(transmittanceInto(s, hitGlass(triangle), eye)), 1e-3);
}
