#pragma once
// Pieces that lie side by side in one plane become one.

#include <span>
#include <vector>

#include "core/atlas/piece_pose.h"

namespace phat {

struct JoinedPieces {
    std::vector<FlatChart> flats;
    std::vector<uint32_t> member;  // per piece: one of those that it was made of
};

/// Boards of a floor, tiles, panels: planar pieces of one kind and plane, less than a texel apart, keep their
/// places beside each other in one flat piece, where that takes fewer texels. Light goes on across such
/// joints, so that interpolation may. Ordered by first triangle.
JoinedPieces joinCoplanar(const Scene& scene, const MeshTopology& topology, std::vector<FlatChart> flats,
                          std::span<const PieceClass> classes, uint32_t gutterTexels);

}  // namespace phat
