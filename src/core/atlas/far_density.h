#pragma once
// Coarser texels far from where the scene is.

#include <span>
#include <vector>

#include "core/atlas/unwrap.h"

namespace phat {

/// Per piece, how fine its texels should be, 1 or less (a ratio of lengths). Seen from the middle of the
/// pieces, texels beyond eight times their median distance take no larger angle than there, and all such far
/// pieces together take no more texels than the others; so a room that stands on a kilometre of ground has
/// half of them. `area`: of the sides that have texels.
std::vector<double> farDensities(const Scene& scene, std::span<const FlatChart> flats,
                                 std::span<const double> area);

/// The same per triangle, before anything is flattened: of the connected part of its surface that it is in. 1
/// for those that are degenerate in `topology`.
std::vector<double> farDensitiesOfTriangles(const Scene& scene, const MeshTopology& topology);

}  // namespace phat
