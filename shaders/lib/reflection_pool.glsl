// Which neighbours' reflection rays count for a pixel's lobe, and how much.
// twin: src/core/render/reflection_pool.cpp, with the numbers' reasons.
#include "lib/mirror_lobe.glsl"
#include "lib/reflection_guides.glsl"

const int kReach = 3;  // pixels; times wideStep() the second time
const float kWidthPerAlpha = 0.8;
const float kMaxAlphaRatio = 1.5;
const float kMinDistance = 1e-3;  // units of length

// Pixels between those that are pooled the second time: the lobes of rough surfaces are alike farther apart.
int wideStep(float alpha) {
    return clamp(int(1.6 + 9.0 * alpha), 1, 4);
}

// At a grazing angle a lobe is narrower from side to side: what likeness() multiplies differences by for that.
// `towardEye`: of the lobe, unit.
vec3 squeezeOf(ReflectionGuide mine, vec3 towardEye) {
    vec3 across = cross(towardEye, mine.mirror);
    float squared = min(0.5 + 0.5 * dot(towardEye, mine.mirror) + mine.alpha * mine.alpha, 1.0);
    return across * sqrt((1.0 / squared - 1.0) / max(dot(across, across), 1e-4));
}

// `step`: from the lobe's position to the other's, units of length. `squeeze`: of `mine`.
float likeness(ReflectionGuide mine, ReflectionGuide other, vec3 step, vec3 squeeze) {
    if (mine.surface != other.surface || mine.alpha < kMinPooledAlpha) return 0.0;
    if (max(mine.alpha, other.alpha) > kMaxAlphaRatio * min(mine.alpha, other.alpha)) return 0.0;
    step /= max(mine.distance, kMinDistance);
    step -= dot(step, mine.mirror) * mine.mirror;
    vec3 apart = (other.mirror - mine.mirror + step) / (kWidthPerAlpha * mine.alpha);
    float aside = dot(apart, squeeze);
    return exp(-0.5 * (dot(apart, apart) + aside * aside));
}
