#pragma once
// Parts of a flat chart whose boxes are smaller than the chart's.

#include <vector>

#include "core/atlas/mesh_topology.h"
#include "core/atlas/unwrap.h"

namespace phat {

/// Cuts a chart that bends, such as a ring or the strip along a bent tube, along its triangles' edges into
/// connected parts, so that the texels in the boxes around the parts, and those along the cuts, are few.
/// Greedy: from single triangles, what saves most is merged first. Parts and their triangles are ascending;
/// one part if cutting saves nothing. Takes time quadratic in the number of triangles at worst.
std::vector<std::vector<uint32_t>> partsWithSmallBoxes(const MeshTopology& topology, const FlatChart& chart,
                                                       double texelSizeMeters);

}  // namespace phat
