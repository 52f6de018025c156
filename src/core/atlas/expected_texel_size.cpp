#include "core/atlas/expected_texel_size.h"

#include <cmath>

#include "core/atlas/far_density.h"
#include "core/atlas/mesh_topology.h"

namespace phat {

double expectedTexelSizeMeters(const Scene& scene, const AtlasSettings& settings) {
    if (settings.texelSizeMeters > 0) return double(settings.texelSizeMeters);
    const MeshTopology topology = buildTopology(scene);
    std::vector<FlatChart> pieces;  // one triangle each
    std::vector<double> areas;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        if (topology.degenerate(t)) continue;
        pieces.emplace_back().triangles = {t};
        areas.push_back(topology.faceArea[t]);
    }
    const std::vector<double> density = farDensities(scene, pieces, areas);
    double area = 0;
    for (size_t i = 0; i < areas.size(); ++i) area += density[i] * density[i] * areas[i];
    return std::sqrt(area / double(settings.texelBudget));
}

}  // namespace phat
