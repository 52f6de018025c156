// A GGX lobe without colour, as it is applied to PHATexels.
#include "lib/brdf.glsl"

struct ScalarLobe {
    vec3 normalWorld;
    float f0;
    float f90;
    float alpha;
};

// D V F, 1/sr, of directions in world space; 0 when either direction is below the horizon.
float lobeBrdfWorld(ScalarLobe l, vec3 towardEye, vec3 towardLight) {
    float nDotV = dot(l.normalWorld, towardEye);
    float nDotL = dot(l.normalWorld, towardLight);
    if (nDotV <= 0.0 || nDotL <= 0.0) return 0.0;
    vec3 h = normalize(towardEye + towardLight);
    float fresnel = schlick(vec3(l.f0), l.f90, dot(towardEye, h)).x;
    return ggxD(min(dot(l.normalWorld, h), 1.0), l.alpha) * smithV(nDotL, nDotV, l.alpha) * fresnel;
}

// D V F cos, of directions in world space.
float lobeValueWorld(ScalarLobe l, vec3 towardEye, vec3 towardLight) {
    return lobeBrdfWorld(l, towardEye, towardLight) * max(dot(l.normalWorld, towardLight), 0.0);
}

// The same of directions in a frame whose z is the lobe's normal.
float lobeValueLocal(ScalarLobe l, vec3 wo, vec3 wi) {
    vec3 h = normalize(wo + wi);
    return ggxD(h.z, l.alpha) * smithV(wi.z, wo.z, l.alpha) * wi.z *
           schlick(vec3(l.f0), l.f90, dot(wo, h)).x;
}
