#include "core/atlas/piece_views.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/atlas/atlas.h"
#include "core/atlas/texel_cover.h"

namespace phat {
namespace {

// Points of a piece that are looked at, how many of them may be open, and how many tell what the piece sees.
constexpr int kPoints = 24;
constexpr int kMaxOpen = 4;
constexpr int kEnoughPoints = 8;
// Of the directions: less leaks in through cracks, and as much is seen from outside a house.
constexpr double kSomeSky = 0.02, kMuchSky = 0.25;
constexpr uint8_t kSkyClasses = 3;

glm::dvec3 cornerOf(const Scene& scene, uint32_t triangle, int corner) {
    return scene.positions[scene.triangles[triangle][corner]];
}

class Viewer {
  public:
    Viewer(const RayScene& rays, const SidedPieces& pieces, double texelSizeMeters)
        : rays_(rays), pieces_(pieces), touchMeters_(kPressedTexels * float(texelSizeMeters)) {}

    PieceView viewOf(uint32_t piece) const {
        switch (pieces_.sides[piece]) {
            case Sides::front:
                return viewOf(piece, false);
            case Sides::back:
                return viewOf(piece, true);
            case Sides::both:
                break;
        }
        const PieceView front = viewOf(piece, false), back = viewOf(piece, true);
        return {front.hidden && back.hidden, uint8_t(front.sky * kSkyClasses + back.sky)};
    }

  private:
    bool isDark(const Hit& hit) const {
        const Sides sides = pieces_.component.empty()
                                ? Sides::front
                                : pieces_.componentSides[pieces_.component[hit.triangle]];
        return sides != Sides::both && hit.backFace != (sides == Sides::back);
    }

    // From points that are equally spaced over the area.
    PieceView viewOf(uint32_t piece, bool back) const {
        const FlatChart& flat = pieces_.flats[piece];
        const Scene& scene = rays_.scene();
        int open = 0, point = 0;
        double passed = 0, sky = 0;
        const auto isKnown = [&] { return open > kMaxOpen && point >= kEnoughPoints; };
        for (size_t i = 0; i < flat.triangles.size() && !isKnown(); ++i) {
            const uint32_t t = flat.triangles[i];
            const glm::dvec3 a = cornerOf(scene, t, 0), e1 = cornerOf(scene, t, 1) - a,
                             e2 = cornerOf(scene, t, 2) - a, cross = glm::cross(e1, e2);
            passed += 0.5 * glm::length(cross);
            glm::vec3 normal(glm::normalize(cross));
            if (back) normal = -normal;
            for (; point < kPoints && (point + 0.5) * flat.area <= passed * kPoints && !isKnown(); ++point) {
                const uint64_t seed = hashOf(0x41d, t, uint64_t(point));
                glm::dvec2 b = Rng(seed).uniform2();
                if (b.x + b.y > 1) b = 1.0 - b;
                const CoverPoint at{rays_.offsetOrigin(glm::vec3(a + b.x * e1 + b.y * e2), normal),
                                    frameFromNormal(normal), touchMeters_, seed + 1};
                const Cover cover = coverOf(at, rays_, [&](const Hit& hit) { return isDark(hit); });
                open += !cover.closed();
                sky += double(cover.sky);
            }
        }
        const bool some = sky >= kSomeSky * point, much = sky >= kMuchSky * point;
        return {point > 0 && open <= kMaxOpen, uint8_t(point == 0 ? 0 : some + much)};
    }

    const RayScene& rays_;
    const SidedPieces& pieces_;
    float touchMeters_;
};

}  // namespace

std::vector<PieceView> viewsOfPieces(const RayScene& rays, const SidedPieces& pieces, double texelSizeMeters,
                                     const Progress& progress) {
    const Viewer viewer(rays, pieces, texelSizeMeters);
    std::vector<PieceView> views(pieces.flats.size());
    tbb::parallel_for(uint32_t(0), uint32_t(views.size()), [&](uint32_t piece) {
        progress.throwIfStopped();
        views[piece] = viewer.viewOf(piece);
    });
    return views;
}

}  // namespace phat
