// What a visible surface reflects of the punctual lights.
#include "lib/lights.glsl"
#include "lib/visible_surface.glsl"

void addPunctualLights(VisibleSurface s, ViewedBrdf viewed, inout vec3 direct) {
    for (int light = 0; light < lightCount; ++light) {
        PunctualSample from = samplePunctual(light, vPosition);
        if (dot(from.towardLight, s.normalGeometric) <= 0.0) continue;
        vec3 reflected =
            evaluateBrdf(viewed, from.towardLight * s.worldFromLocal, from.discRadius) * from.irradiance;
        if (maxComponent(reflected) > 0.0)
            direct += reflected * shadowVisibility(light, vPosition, s.normalGeometric);
    }
}
