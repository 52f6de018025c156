// Which texels of some blocks are inside of something, or pressed against it, after it has moved: their normals, or that
// they are covered.
// twin: surroundedByDark in src/core/atlas/texel_cover.cpp, coverOf in src/core/atlas/texel_cover.h, with other random
// numbers; narrow strips are not told from others, and glass is as good as a wall.
#include "lib/atlas.glsl"
#include "lib/bvh.glsl"
#include "lib/frame.glsl"
#include "lib/hemisphere_map.glsl"
#include "lib/hit_surface.glsl"
#include "lib/random.glsl"
#include "lib/ray_origin.glsl"
#include "lib/texel_batch.glsl"
#include "lib/texel_point.glsl"

layout(location = 0) out uint normalOut;  // as texelNormals has it, which is of texels that nothing covers here

const float kPressedTexels = 0.25;
const float kMaxDark = 0.5, kMaxBlocked = 0.9;
const int kStrata = 4;  // per axis
const float kFar = 1e30;

// Whether the side that was hit has no texels, while the other one has.
bool isDark(BvhHit hit) {
    uvec2 charts = hitTexel(hitFirstTriangle + kHitTriangleTexels * hit.triangle + 1).zw;
    return (hit.backFace ? charts.y : charts.x) == kHitNoChart && any(notEqual(charts, uvec2(kHitNoChart)));
}

void main() {
    normalOut = kNoIrradiance;
    BatchTexel t = batchTexelAt(ivec2(gl_FragCoord.xy));
    if (!t.valid) return;
    TexelPoint point = texelPointAt(t.texel);
    if (!point.valid) return;
    vec3 origin = offsetOrigin(point.position, point.flatNormal, vec3(0.0));
    mat3 worldFromLocal = frameFromNormal(point.normal);
    vec2 shift = randomNumbers(uvec3(t.texel, 0u)).xy;
    float touch = kPressedTexels * texelSizeOfTile(t.texel >> 3);
    float dark = 0.0, blocked = 0.0, all = 0.0;
    for (int ray = 0; ray < kStrata * kStrata; ++ray) {
        vec2 stratum = vec2(float(ray % kStrata), float(ray / kStrata));
        vec3 local = squareToHemisphere(fract((stratum + shift) / float(kStrata)));
        BvhHit hit = closestHit(origin, worldFromLocal * local, kFar);
        all += local.z;
        if (hit.triangle < 0) continue;
        dark += isDark(hit) ? 1.0 : 0.0;
        if (hit.distance * local.z < touch) blocked += local.z;
    }
    bool covered = dark >= kMaxDark * float(kStrata * kStrata) || blocked >= kMaxBlocked * all;
    normalOut = covered ? kCovered : texelFetch(texelNormals, t.texel, 0).x;
}
