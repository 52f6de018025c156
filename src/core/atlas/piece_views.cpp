#include "core/atlas/piece_views.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/atlas/area_points.h"
#include "core/atlas/atlas.h"
#include "core/atlas/texel_cover.h"
#include "core/scene/triangle_corners.h"

namespace phat {
namespace {

// Points of a piece that are looked at, how many of them may be open, and how many tell what the piece sees.
constexpr int kPoints = 24;
constexpr int kMaxOpen = 4;
constexpr int kEnoughPoints = 8;
// Of the directions: less leaks in through cracks, and as much is seen from outside a house.
constexpr double kSomeSky = 0.02, kMuchSky = 0.25;
constexpr uint8_t kSkyClasses = 3;

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
        AreaPoints points(kPoints, flat.area);
        int open = 0, looked = 0;
        double sky = 0;
        const auto isKnown = [&] { return open > kMaxOpen && looked >= kEnoughPoints; };
        for (size_t i = 0; i < flat.triangles.size() && !isKnown(); ++i) {
            const uint32_t t = flat.triangles[i];
            const auto corners = cornersOf<glm::dvec3>(scene, t);
            glm::vec3 normal(glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0])));
            if (back) normal = -normal;
            for (const auto& [position, seed] : points.next(corners, {0x41d, t})) {
                if (isKnown()) break;
                const CoverPoint at{rays_.offsetOrigin(glm::vec3(position), normal), frameFromNormal(normal),
                                    touchMeters_, seed + 1};
                const Cover cover = coverOf(at, rays_, [&](const Hit& hit) { return isDark(hit); });
                open += !cover.closed();
                sky += double(cover.sky);
                ++looked;
            }
        }
        const bool some = sky >= kSomeSky * looked, much = sky >= kMuchSky * looked;
        return {looked > 0 && open <= kMaxOpen, uint8_t(looked == 0 ? 0 : some + much)};
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
