#pragma once
// The scene's surface as flat pieces in metres, before they are packed into the atlas.

#include <array>
#include <vector>

#include "core/atlas/mesh_topology.h"
#include "core/base/progress.h"
#include "core/scene/scene.h"

namespace phat {

/// The stretch that counts as good: both singular values within [1/1.5, 1.5].
inline constexpr double kGoodStretch = 1.5;

struct FlatChart {
    std::vector<uint32_t> triangles;                  // the scene's, ascending
    std::vector<std::array<glm::dvec2, 3>> uvMeters;  // per triangle corner; counter-clockwise
    glm::dvec2 sizeMeters{0};                         // all of uvMeters is in [0, sizeMeters]; x >= y
    double area = 0;                                  // of the surface, square metres
    double areaWithinStretch15 = 0;                   // fraction of it
};

/// What decides whether rings and arcs are worth cutting.
struct ChartCost {
    double texelSizeMeters = 0;  // about
    uint32_t gutterTexels = 0;   // around large charts
};

/// Cuts every surface into connected, near-isometric charts without overlaps. All triangles but the
/// degenerate are in exactly one chart. Ordered by first triangle.
std::vector<FlatChart> unwrapScene(const Scene& scene, const MeshTopology& topology,
                                   float maxNormalConeDegrees, const ChartCost& cost, Progress& progress);

/// Takes the islands of UV set 0 or 1 as charts, each scaled to its surface's area, otherwise in its own
/// shape; mirrored islands are mirrored back. Throws std::runtime_error with the reason if the set is
/// missing, not in [0, 1], or maps two points of the surface to one or a triangle to nothing. Overlaps are
/// looked for at `checkResolution` texels a side.
std::vector<FlatChart> chartsFromUvSet(const Scene& scene, const MeshTopology& topology, int uvSet,
                                       uint32_t checkResolution, Progress& progress);

}  // namespace phat
