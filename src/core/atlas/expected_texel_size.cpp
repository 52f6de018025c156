#include "core/atlas/expected_texel_size.h"

#include <cmath>

#include "core/atlas/far_density.h"
#include "core/atlas/mesh_topology.h"

namespace phat {

double expectedTexelSizeMeters(const Scene& scene, const AtlasSettings& settings) {
    if (settings.texelSizeMeters > 0) return double(settings.texelSizeMeters);
    const MeshTopology topology = buildTopology(scene);
    const std::vector<double> density = farDensitiesOfTriangles(scene, topology);
    double area = 0;
    for (size_t t = 0; t < density.size(); ++t) area += density[t] * density[t] * topology.faceArea[t];
    return std::sqrt(area / double(settings.texelBudget));
}

}  // namespace phat
