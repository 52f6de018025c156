#pragma once
// Which sections could divide a surface.

#include "core/atlas/wall_sections.h"

namespace phat {

/// Leaves out sections on the border of a face, the triangles that hang together without a fold, and those of
/// faces that they would shatter, such as a screed under the joints of a thousand boards: over 1,000 sections
/// and less than 16 texels for each. Keeps the order.
std::vector<WallSection> dividingSections(std::vector<WallSection> sections, const Scene& scene,
                                          const MeshTopology& topology, double texelSizeMeters);

}  // namespace phat
