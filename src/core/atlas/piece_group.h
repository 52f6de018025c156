#pragma once
// Small pieces of surface that share a chart.
//
// A chart has whole tiles of its own, so that a piece of a few texels would take some hundred. Pieces that
// are near each other and face the same way are laid side by side in one chart instead (piece_place.h).

#include <algorithm>
#include <span>
#include <vector>

#include "core/atlas/piece_place.h"
#include "core/atlas/piece_pose.h"

namespace phat {

/// A flat piece in a chart, turned counter-clockwise by so many right angles.
struct LaidPiece {
    uint32_t flat = 0;
    uint32_t turns = 0;  // 0..3
};

/// The pieces of one chart.
using PieceGroup = std::vector<LaidPiece>;

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
    std::vector<glm::uvec2> origin, size;  // per piece, texels
    std::vector<glm::dvec2> drawn;         // per piece, its size in that place, texels
};

/// `sizesTexels`: of the pieces, as they are turned. `freedom`: see placeOf.
GroupLayout layOutGroup(std::span<const glm::dvec2> sizesTexels, double freedom);
/// About how many tiles it takes, much faster.
double estimateGroupTiles(std::span<const glm::dvec2> sizesTexels);

}  // namespace phat
