#include "core/atlas/hidden_pieces.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/atlas/atlas.h"
#include "core/atlas/texel_cover.h"

namespace phat {
namespace {

// Points of a piece that are looked at, and how many of them may be open.
constexpr int kPoints = 24;
constexpr int kMaxOpen = 4;

glm::dvec3 cornerOf(const Scene& scene, uint32_t triangle, int corner) {
    return scene.positions[scene.triangles[triangle][corner]];
}

}  // namespace

std::vector<uint8_t> hiddenPieces(const RayScene& rays, const SidedPieces& pieces, double texelSizeMeters,
                                  const Progress& progress) {
    const Scene& scene = rays.scene();
    const auto isDark = [&](const Hit& hit) {
        const Sides sides =
            pieces.component.empty() ? Sides::front : pieces.componentSides[pieces.component[hit.triangle]];
        return sides != Sides::both && hit.backFace != (sides == Sides::back);
    };
    // Whether few points of a side are open, equally spaced over its area.
    const auto isHidden = [&](uint32_t piece, bool back) {
        const FlatChart& flat = pieces.flats[piece];
        int open = 0, point = 0;
        double passed = 0;
        for (const uint32_t t : flat.triangles) {
            const glm::dvec3 a = cornerOf(scene, t, 0), e1 = cornerOf(scene, t, 1) - a,
                             e2 = cornerOf(scene, t, 2) - a, cross = glm::cross(e1, e2);
            passed += 0.5 * glm::length(cross);
            glm::vec3 normal(glm::normalize(cross));
            if (back) normal = -normal;
            for (; point < kPoints && (point + 0.5) * flat.area <= passed * kPoints; ++point) {
                const uint64_t seed = hashOf(0x41d, t, uint64_t(point));
                glm::dvec2 b = Rng(seed).uniform2();
                if (b.x + b.y > 1) b = 1.0 - b;
                const CoverPoint at{rays.offsetOrigin(glm::vec3(a + b.x * e1 + b.y * e2), normal),
                                    frameFromNormal(normal), kPressedTexels * float(texelSizeMeters),
                                    seed + 1};
                open += !coverOf(at, rays, isDark).closed();
                if (open > kMaxOpen) return false;
            }
        }
        return point > 0;
    };
    std::vector<uint8_t> hidden(pieces.flats.size(), 0);
    tbb::parallel_for(uint32_t(0), uint32_t(hidden.size()), [&](uint32_t piece) {
        progress.throwIfStopped();
        const Sides sides = pieces.sides[piece];
        hidden[piece] = (sides == Sides::back || isHidden(piece, false)) &&
                        (sides == Sides::front || isHidden(piece, true));
    });
    return hidden;
}

}  // namespace phat
