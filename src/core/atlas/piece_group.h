#pragma once
// Small pieces of surface that share a chart.
//
// A chart has whole tiles of its own, so that a piece of a few texels would take some hundred. Pieces that
// are near each other and face the same way are laid side by side in one chart instead, each with a ring of
// texels of its own, so that no bilinear lookup reaches from one to another.

#include <algorithm>
#include <span>
#include <vector>

#include "core/atlas/piece_pose.h"

namespace phat {

/// A flat piece in a chart, turned counter-clockwise by so many right angles.
struct LaidPiece {
    uint32_t flat = 0;
    uint32_t turns = 0;  // 0..3
};

/// The pieces of one chart.
using PieceGroup = std::vector<LaidPiece>;

/// Texels around each of several pieces in a chart: what bilinear interpolation on the piece reaches.
inline constexpr uint32_t kPieceGutter = 1;
/// How wide what is narrower than a texel is drawn. Interpolation then takes its own texels and all but
/// nothing of those beside them, and it needs no ring. In an atlas of 16,384 texels, floats still tell its
/// sides apart.
inline constexpr double kNarrowTexels = 1.0 / 256;

inline bool isNarrow(double sizeTexels) {
    return sizeTexels < 1;
}

/// Whether a piece has a chart of its own, with the atlas's gutter. A small one has a ring, alone as well.
inline bool isLargePiece(glm::dvec2 sizeTexels) {
    constexpr double kLargeTexels = 8;
    return std::min(sizeTexels.x, sizeTexels.y) >= kLargeTexels;
}

/// Every piece is in one group. Pieces that fill tiles of their own well are alone; a group's others are of
/// one kind, at most half a block's width apart and face the same way. `gutterTexels`: as the atlas's
/// settings. Ordered by first piece.
std::vector<PieceGroup> groupPieces(const Scene& scene, const MeshTopology& topology,
                                    std::span<const FlatChart> flats, std::span<const PieceClass> classes,
                                    uint32_t gutterTexels, const Progress& progress);

/// Every piece in a chart of its own, as the islands of a UV set are.
std::vector<PieceGroup> alone(size_t pieceCount);

/// Where the pieces of a chart lie in its texels.
struct GroupLayout {
    glm::uvec2 sizeTiles{1};
    std::vector<glm::uvec2> origin, size;  // per piece, texels; the ring included
};

/// `sizesTexels`: of the pieces, as they are turned.
GroupLayout layOutGroup(std::span<const glm::dvec2> sizesTexels);
/// About how many tiles it takes, much faster.
double estimateGroupTiles(std::span<const glm::dvec2> sizesTexels);

}  // namespace phat
