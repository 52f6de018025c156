// Albedo of a unit specular lobe in terms of f0 and f90, by quasi-Monte Carlo over visible normals.
// twin: integrateSplitSum in src/core/scene/brdf.cpp, with its source; tests/gl compares the two.
#include "lib/block_layout.glsl"
#include "lib/brdf.glsl"
#include "lib/visible_normal.glsl"

vec2 integrateSplitSum(float nDotV, float alpha) {
    const uint kSamples = 1024u;
    vec3 v = vec3(sqrt(max(0.0, 1.0 - nDotV * nDotV)), 0.0, nDotV);
    vec2 sum = vec2(0.0);
    for (uint i = 0u; i < kSamples; ++i) {
        vec2 square = vec2(float(i) + 0.5, float(reverse10(i))) / float(kSamples);
        vec3 h = squareToVisibleNormal(square, v, alpha);
        float vDotH = max(dot(v, h), 0.0);
        vec3 l = 2.0 * vDotH * h - v;
        if (l.z <= 0.0) continue;
        float shadowing = 4.0 * l.z * v.z * smithV(l.z, v.z, alpha) / smithG1(v.z, alpha);
        float m = 1.0 - vDotH;
        float grazing = m * m * m * m * m;
        sum += vec2(1.0 - grazing, grazing) * shadowing;
    }
    return sum / float(kSamples);
}
