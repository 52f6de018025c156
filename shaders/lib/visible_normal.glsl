// Sampling of GGX's visible normals, and densities of directions sampled from them.
#include "lib/hemisphere_map.glsl"

// source: Heitz 2018, "Sampling the GGX Distribution of Visible Normals", section 3.
// twin: squareToVisibleNormal in src/core/scene/brdf.h; tests/gl compares the two.
vec3 squareToVisibleNormal(vec2 s, vec3 towardEye, float alpha) {
    vec3 v = normalize(vec3(alpha * towardEye.xy, towardEye.z));
    float length2 = dot(v.xy, v.xy);
    vec3 across = length2 > 0.0 ? vec3(-v.y, v.x, 0.0) * inversesqrt(length2) : vec3(1.0, 0.0, 0.0);
    vec3 along = cross(v, across);
    float radius = sqrt(s.x);
    float angle = 2.0 * kPi * s.y;
    float p1 = radius * cos(angle);
    float blend = 0.5 * (1.0 + v.z);
    float p2 = (1.0 - blend) * sqrt(max(0.0, 1.0 - p1 * p1)) + blend * radius * sin(angle);
    vec3 n = p1 * across + p2 * along + sqrt(max(0.0, 1.0 - p1 * p1 - p2 * p2)) * v;
    return normalize(vec3(alpha * n.xy, max(n.z, 1e-6)));
}

// Density of reflecting `towardEye` about a visible normal and then missing by an angle of mean square `spread2`:
// the lobe with alpha^2 grown by half of it, and by the foreshortening of half vectors in the plane of the eye.
// source: anisotropic GGX and its masking (Heitz 2014); the growth is ours, a Gaussian's convolution as a model.
float smoothedLobePdf(vec3 towardEye, vec3 towardLight, float alpha, float spread2) {
    vec3 h = normalize(towardEye + towardLight);
    float vDotH = max(0.1, dot(towardEye, h));
    vec2 growth = 0.5 * spread2 / vec2(1.0, vDotH * vDotH);
    vec2 a = sqrt(vec2(alpha * alpha) + growth);
    vec2 x = dot(towardEye.xy, towardEye.xy) > 1e-8 ? normalize(towardEye.xy) : vec2(1.0, 0.0);
    vec2 y = vec2(-x.y, x.x);
    vec2 slopes = vec2(dot(h.xy, x), dot(h.xy, y)) / a;
    float d = dot(slopes, slopes) + h.z * h.z;
    float ggx = 1.0 / (kPi * a.x * a.y * d * d);
    float stretched = length(vec3(dot(towardEye.xy, x) * a.x, dot(towardEye.xy, y) * a.y, towardEye.z));
    // G1 max(v.h, 0) D / v.z / (4 v.h) with G1 = 2 v.z / (v.z + stretched).
    return ggx / (2.0 * (towardEye.z + stretched));
}

// A point of the unit disc with a density that falls off like a cone; each `turn` gives another one.
vec2 squareToCone(vec2 s, float turn) {
    // The inverse of 3 r^2 - 2 r^3.
    float r = 0.5 - sin(asin(1.0 - 2.0 * s.x) / 3.0);
    float angle = 2.0 * kPi * (s.y + 0.618034 * turn);
    return r * vec2(cos(angle), sin(angle));
}
