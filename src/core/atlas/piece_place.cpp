#include "core/atlas/piece_place.h"

#include <cmath>

#include "core/atlas/atlas.h"

namespace phat {
namespace {

// A length that is a whole number of texels but for rounding must not take another one.
constexpr double kSlackTexels = 1e-4;
// Shorter sides may be stretched or squeezed: a texel more or less is much of them.
constexpr double kFewTexels = 8;

}  // namespace

bool isLargePiece(glm::dvec2 sizeTexels) {
    constexpr double kLargeTexels = 24;
    return std::min(sizeTexels.x, sizeTexels.y) >= kLargeTexels;
}

glm::uvec2 placeOf(glm::dvec2 sizeTexels, double freedom) {
    glm::uvec2 place(1);
    for (int axis = 0; axis < 2; ++axis) {
        const double size = sizeTexels[axis];
        if (isNarrow(size)) continue;
        double texels = std::ceil(size - kSlackTexels);
        const double nearest = std::max(std::round(size), 1.0);
        if (size < kFewTexels && size <= freedom * nearest) texels = nearest;
        place[axis] = uint32_t(texels) + 2 * kPieceGutter;
    }
    return place;
}

glm::dvec2 drawnSize(glm::dvec2 sizeTexels, glm::uvec2 place, double freedom) {
    glm::dvec2 drawn;
    for (int axis = 0; axis < 2; ++axis) {
        const double whole = place[axis] == 1 ? kNarrowTexels : place[axis] - 2 * kPieceGutter;
        const double most = (sizeTexels[axis] < kFewTexels ? freedom : 1.0) * sizeTexels[axis];
        drawn[axis] = std::min(whole, most);
    }
    return drawn;
}

glm::dvec2 drawnOrigin(glm::dvec2 drawnTexels, glm::uvec2 place) {
    glm::dvec2 origin;
    for (int axis = 0; axis < 2; ++axis)
        origin[axis] = place[axis] == 1 ? 0.5 - 0.5 * drawnTexels[axis] : double(kPieceGutter);
    return origin;
}

double texelsAlone(glm::dvec2 sizeTexels, uint32_t gutterTexels) {
    // As the packer does, a chart may be a little coarser to end where a tile does.
    const glm::dvec2 tiles =
        glm::ceil((sizeTexels / kFillFreedom + 2.0 * gutterTexels - kSlackTexels) / double(kTileSize));
    return std::max(tiles.x, 1.0) * std::max(tiles.y, 1.0) * kTileSize * kTileSize;
}

double texelsTaken(glm::dvec2 sizeTexels, uint32_t gutterTexels) {
    return isLargePiece(sizeTexels) ? texelsAlone(sizeTexels, gutterTexels)
                                    : texelsOf(placeOf(sizeTexels, kPieceFreedom));
}

}  // namespace phat
