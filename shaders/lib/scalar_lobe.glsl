// A GGX lobe without colour, as the passes over the atlas apply it to PHATexels.
#include "lib/brdf.glsl"

struct Lobe {
    vec3 normal;
    float f0;
    float f90;
    float alpha;
};

// D V F, 1/sr; 0 when either direction is below the horizon.
float lobeBrdf(Lobe l, vec3 towardEye, vec3 towardLight) {
    float nDotV = dot(l.normal, towardEye);
    float nDotL = dot(l.normal, towardLight);
    if (nDotV <= 0.0 || nDotL <= 0.0) return 0.0;
    vec3 h = normalize(towardEye + towardLight);
    float fresnel = schlick(vec3(l.f0), l.f90, dot(towardEye, h)).x;
    return ggxD(min(dot(l.normal, h), 1.0), l.alpha) * smithV(nDotL, nDotV, l.alpha) * fresnel;
}

// D V F cos.
float lobeValue(Lobe l, vec3 towardEye, vec3 towardLight) {
    return lobeBrdf(l, towardEye, towardLight) * max(dot(l.normal, towardLight), 0.0);
}
