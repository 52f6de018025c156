#pragma once
// How many texels a flat piece takes in the atlas.
//
// A large piece has a chart of its own, in whole tiles and with the atlas's gutter. A smaller one has a place
// in a chart of several, with a ring of texels of its own, so that no bilinear lookup reaches from one to
// another.

#include <algorithm>

#include "core/base/math.h"

namespace phat {

/// How much longer or shorter than in the world a side of few texels may be drawn, so that it is a whole
/// number of texels.
inline constexpr double kPieceFreedom = 1.25;
/// Texels around a piece in its place: what bilinear interpolation on the piece reaches.
inline constexpr uint32_t kPieceGutter = 1;
/// How wide what is narrower than a texel is drawn, in the middle of a row of its own. Interpolation then
/// takes that row and all but nothing of those beside it, and it needs no ring. In an atlas of 16,384 texels,
/// floats still tell its sides apart.
inline constexpr double kNarrowTexels = 1.0 / 256;

inline bool isNarrow(double sizeTexels) {
    return sizeTexels < 1;
}

/// Whether a piece has a chart of its own, with the atlas's gutter.
bool isLargePiece(glm::dvec2 sizeTexels);

/// The place of a piece that is not large, texels, the ring included. `freedom`: 1, or kPieceFreedom.
glm::uvec2 placeOf(glm::dvec2 sizeTexels, double freedom);
/// How large a piece of this size is drawn in such a place, texels.
glm::dvec2 drawnSize(glm::dvec2 sizeTexels, glm::uvec2 place, double freedom);
/// Where it is drawn: its low corner, from that of the place.
glm::dvec2 drawnOrigin(glm::dvec2 drawnTexels, glm::uvec2 place);

/// Texels of a chart of its own in whole tiles, gutter included.
double texelsAlone(glm::dvec2 sizeTexels, uint32_t gutterTexels);
/// Texels that a piece takes, alone if it is large, and of its place otherwise.
double texelsTaken(glm::dvec2 sizeTexels, uint32_t gutterTexels);

inline double texelsOf(glm::uvec2 size) {
    return double(size.x) * double(size.y);
}

}  // namespace phat
