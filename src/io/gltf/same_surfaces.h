#pragma once
// Which surfaces of one file are in another.

#include <vector>

#include "core/atlas/earlier_charts.h"
#include "io/gltf/gltf_source.h"

namespace phat {

/// A scene and the file that it was loaded from.
struct SourcedScene {
    const GltfSource& source;
    const Scene& scene;
};

/// Per surface of `now`, one of `before` with the same triangles in the space of its node, which is placed at
/// the same scale, or kNewSurface; none is named twice: EarlierCharts::earlierSurface. Normals, texture
/// coordinates, materials and places may be others. Surfaces of one node have theirs in one node. Of several
/// equal nodes, those with the same name and place are taken first, then those with the same place, with the
/// same name, and any, in the files' order. Throws std::runtime_error where a file does not hold what the
/// scene was loaded from.
std::vector<uint32_t> sameSurfaces(const SourcedScene& now, const SourcedScene& before);

}  // namespace phat
