#include "core/atlas/hidden_pieces.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/atlas/area_points.h"
#include "core/atlas/atlas.h"
#include "core/atlas/texel_cover.h"
#include "core/scene/triangle_corners.h"

namespace phat {
namespace {

// Points of a piece that are looked at, and how many of them may be open.
constexpr int kPoints = 24;
constexpr int kMaxOpen = 4;

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
        AreaPoints points(kPoints, flat.area);
        int open = 0;
        for (const uint32_t t : flat.triangles) {
            const auto corners = cornersOf<glm::dvec3>(scene, t);
            glm::vec3 normal(glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0])));
            if (back) normal = -normal;
            for (const auto& [position, seed] : points.next(corners, {0x41d, t})) {
                const CoverPoint at{rays.offsetOrigin(glm::vec3(position), normal), frameFromNormal(normal),
                                    kPressedTexels * float(texelSizeMeters), seed + 1};
                open += !coverOf(at, rays, isDark).closed();
                if (open > kMaxOpen) return false;
            }
        }
        return points.visited() > 0;
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
