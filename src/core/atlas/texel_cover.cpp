// Occluded texels: inside closed objects, or under objects that stand on the surface.

#include "core/atlas/texel_cover.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "core/atlas/atlas.h"
#include "core/scene/triangle_corners.h"

namespace phat {
namespace {

// Gutters are checked half a texel above their surface, so that the sag of a finely tessellated concave
// surface under its own tangent plane (d^2 / 2r) does not count as passing through geometry.
constexpr float kGutterLiftTexels = 0.5f;
// The way begins a little inside the triangle: a wall along its edge has to be crossed.
constexpr float kStartTexels = 0.125f;
// What is more than so many altitudes of its triangle above a texel does not touch it.
constexpr float kNarrowAltitudes = 2;

float altitudeOf(const Scene& scene, uint32_t triangle) {
    const auto [a, b, c] = cornersOf(scene, triangle);
    const float longest = std::max({glm::distance(a, b), glm::distance(a, c), glm::distance(b, c)});
    return longest > 0 ? glm::length(glm::cross(b - a, c - a)) / longest : 0.0f;
}

bool sideLit(const Atlas& atlas, uint32_t triangle, bool backFace) {
    const uint32_t chart = atlas.triangleChart[triangle];
    if (chart == kNoChart) return true;  // degenerate: no information
    return atlas.charts[chart].back == backFace || atlas.charts[chart].otherSide != kNoChart;
}

// `texelSizeMeters` here and below: of the texel's chart.
bool surroundedByDark(const TexelPoints& points, const Atlas& atlas, float texelSizeMeters,
                      const RayScene& rays, size_t i) {
    // Beside a strip that is much narrower than a texel, much touches it by that measure.
    const float size =
        std::min(texelSizeMeters, kNarrowAltitudes * altitudeOf(rays.scene(), points.triangle[i]));
    const CoverPoint point{rays.offsetOrigin(points.position[i], points.normal[i]),
                           frameFromNormalAndTangent(points.normal[i], points.tangent[i]),
                           kPressedTexels * size, hashOf(i)};
    const auto isDark = [&](const Hit& hit) { return !sideLit(atlas, hit.triangle, hit.backFace); };
    return coverOf(point, rays, isDark).closed();
}

bool isBlocked(const RayScene& rays, glm::vec3 from, glm::vec3 to) {
    const float distance = glm::distance(from, to);
    return distance > 0 && rays.anyHit(from, (to - from) / distance, distance);
}

// Whether something steep stands on the way: the surface itself, where it is curved, is not steep.
bool isWalled(const RayScene& rays, glm::vec3 from, glm::vec3 to, glm::vec3 normal) {
    constexpr int kMaxHits = 8;
    constexpr float kMaxCosine = 0.5f;
    for (int hits = 0; hits < kMaxHits; ++hits) {
        const float distance = glm::distance(from, to);
        if (!(distance > 0)) return false;
        const glm::vec3 direction = (to - from) / distance;
        const Hit hit = rays.closestHit(from, direction, distance);
        if (!hit) return false;
        const Scene& scene = rays.scene();
        const glm::uvec3& v = scene.triangles[hit.triangle];
        const glm::vec3 across = glm::cross(scene.positions[v[1]] - scene.positions[v[0]],
                                            scene.positions[v[2]] - scene.positions[v[0]]);
        if (std::abs(glm::dot(across, normal)) < kMaxCosine * glm::length(across)) return true;
        from = rays.offsetOrigin(from + hit.distance * direction, direction);
    }
    return false;
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
    const glm::vec3 middle = (scene.positions[v[0]] + scene.positions[v[1]] + scene.positions[v[2]]) / 3.0f;
    const float toMiddle = glm::distance(edge, middle);
    const float inward = std::min(kStartTexels * texelSizeMeters, 0.5f * toMiddle);
    const glm::vec3 start = toMiddle > 0 ? edge + inward / toMiddle * (middle - edge) : edge;

    const glm::vec3 lift = kGutterLiftTexels * texelSizeMeters * points.normal[i];
    return isBlocked(rays, start + lift, points.position[i] + lift) ||
           isWalled(rays, rays.offsetOrigin(start, points.normal[i]),
                    rays.offsetOrigin(points.position[i], points.normal[i]), points.normal[i]);
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
