// Occluded texels: inside closed objects, or under objects that stand on the surface.

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "core/atlas/atlas.h"
#include "core/base/hemisphere_map.h"
#include "core/base/random.h"
#include "core/scene/glass.h"

namespace phat {
namespace {

constexpr int kStrata = 4;  // per axis: 16 rays a texel
constexpr int kRays = kStrata * kStrata;
// Half of the rays meet unlit backs: the texel is inside or under an object. For texels beside a wall's foot
// it is at most a little less than half.
constexpr int kMaxDeadRays = kRays / 2;
// Nine tenths of the hemisphere, by cosine, are blocked less than a quarter of a texel above the surface: an
// object touches it. Height instead of distance, weighted by cosine, so that the border of the contact is not
// speckled.
constexpr float kMaxBlocked = 0.9f;
constexpr float kPressedTexels = 0.25f;
// Gutters are checked half a texel above their surface, so that the sag of a finely tessellated concave
// surface under its own tangent plane (d^2 / 2r) does not count as passing through geometry.
constexpr float kGutterLiftTexels = 0.5f;

bool sideLit(const Atlas& atlas, uint32_t triangle, bool backFace) {
    const uint32_t chart = atlas.triangleChart[triangle];
    if (chart == kNoChart) return true;  // degenerate: no information
    return atlas.charts[chart].back == backFace || atlas.charts[chart].otherSide != kNoChart;
}

// `texelSizeMeters` here and below: of the texel's chart.
bool surroundedByDark(const TexelPoints& points, const Atlas& atlas, float texelSizeMeters,
                      const RayScene& rays, size_t i) {
    const Frame frame = frameFromNormalAndTangent(points.normal[i], points.tangent[i]);
    const glm::vec3 origin = offsetOrigin(points.position[i], points.normal[i]);
    Rng rng(hashOf(i));
    const glm::vec2 shift = rng.uniform2();
    int dead = 0;
    float blocked = 0, sky = 0;
    uint64_t rayCount = 0;
    for (int ray = 0; ray < kRays; ++ray) {
        const glm::vec2 stratum(float(ray % kStrata), float(ray / kStrata));
        const glm::vec2 square = glm::fract((stratum + shift) / float(kStrata));
        const glm::vec3 local = squareToHemisphere(square);
        // What lies under or in glass is lit through it.
        const Ray toward{origin, glm::normalize(frame.toWorld(local))};
        const Hit hit = seeStraight(rays, toward, kFarDistance, rayCount).hit;
        sky += local.z;
        if (!hit) continue;
        dead += !sideLit(atlas, hit.triangle, hit.backFace);
        if (hit.distance * local.z < kPressedTexels * texelSizeMeters) blocked += local.z;
    }
    return dead >= kMaxDeadRays || blocked >= kMaxBlocked * sky;
}

// Whether the segment from the surface's edge to an extrapolated point is occluded.
bool behindGeometry(const TexelPoints& points, float texelSizeMeters, const RayScene& rays, size_t i) {
    const Scene& scene = rays.scene();
    const glm::uvec3& v = scene.triangles[points.triangle[i]];
    // Clamping the weights is not the nearest point of the triangle, but one of it, and near enough.
    glm::vec3 weights(1 - points.barycentric[i].x - points.barycentric[i].y, points.barycentric[i]);
    weights = glm::max(weights, glm::vec3(0));
    weights /= weights.x + weights.y + weights.z;
    const glm::vec3 edge = weights.x * scene.positions[v[0]] + weights.y * scene.positions[v[1]] +
                           weights.z * scene.positions[v[2]];

    const glm::vec3 lift = kGutterLiftTexels * texelSizeMeters * points.normal[i];
    const glm::vec3 from = edge + lift, to = points.position[i] + lift;
    const float distance = glm::distance(from, to);
    if (!(distance > 0)) return false;
    return rays.anyHit(from, (to - from) / distance, distance);
}

}  // namespace

bool isOccludedTexel(const TexelPoints& points, const Atlas& atlas, const RayScene& rays, size_t texel) {
    const uint32_t chart = atlas.chartAt(size_t(texel));
    const float texelSize = atlas.charts[chart].texelSizeMeters;
    const bool gutter = points.state[texel] == TexelState::gutter;
    return (gutter && behindGeometry(points, texelSize, rays, texel)) ||
           surroundedByDark(points, atlas, texelSize, rays, texel);
}

void markOccludedTexels(TexelPoints& points, const Atlas& atlas, const RayScene& rays, Progress& progress) {
    progress.begin("find occluded texels", points.sizeTexels.y);
    tbb::parallel_for(uint32_t(0), points.sizeTexels.y, [&](uint32_t y) {
        progress.throwIfStopped();
        for (uint32_t x = 0; x < points.sizeTexels.x; ++x) {
            const size_t i = size_t(y) * points.sizeTexels.x + x;
            if (points.valid(i) && isOccludedTexel(points, atlas, rays, i))
                points.state[i] = TexelState::occluded;
        }
        progress.advance(1);
    });
    progress.end();
}

}  // namespace phat
