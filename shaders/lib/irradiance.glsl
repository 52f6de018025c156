// The baked irradiance at a point of the atlas.
#include "lib/atlas.glsl"

uniform sampler2DArray irradiance;  // 0 indirect, 1 area lights

#ifdef AREA
const int kSources = 2;
#else
const int kSources = 1;
#endif

// Bilinear inside the chart.
void irradianceAt(vec2 center, uint chart, out vec3 bySource[kSources]) {
    ivec2 corner = ivec2(floor(center - 0.5));
    vec2 t = center - 0.5 - vec2(corner);
    float weights = 0.0;
    for (int source = 0; source < kSources; ++source) bySource[source] = vec3(0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 side = ivec2(i & 1, i >> 1), texel = corner + side;
        if (chartAt(texel) != chart) continue;
        float weight = (side.x == 1 ? t.x : 1.0 - t.x) * (side.y == 1 ? t.y : 1.0 - t.y);
        for (int source = 0; source < kSources; ++source)
            bySource[source] += weight * texelFetch(irradiance, ivec3(texel, source), 0).rgb;
        weights += weight;
    }
    for (int source = 0; source < kSources; ++source)
        bySource[source] = weights > 0.0 ? bySource[source] / weights : vec3(0.0);
}
