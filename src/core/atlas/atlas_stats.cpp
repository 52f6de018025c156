#include "core/atlas/atlas_stats.h"

#include "core/atlas/atlas_raster.h"

namespace phat {

float coverageOf(const Atlas& atlas) {
    std::vector<bool> hasSurface(atlas.texelCount(), false);
    for (size_t t = 0; t < atlas.triangleChart.size(); ++t) {
        if (atlas.triangleChart[t] == kNoChart) continue;
        const Chart& chart = atlas.charts[atlas.triangleChart[t]];
        const glm::uvec2 toOther = chart.otherSide == kNoChart
                                       ? glm::uvec2(0)
                                       : atlas.charts[chart.otherSide].originTexel() - chart.originTexel();
        forEachTexel(atlas.triangleTexels[t], int(atlas.sizeTexels.x), int(atlas.sizeTexels.y),
                     [&](int x, int y) {
                         const glm::uvec2 texel(x, y),
                             other = texel + toOther;  // wraps around, as unsigned numbers do
                         hasSurface[size_t(texel.y) * atlas.sizeTexels.x + texel.x] = true;
                         hasSurface[size_t(other.y) * atlas.sizeTexels.x + other.x] = true;
                     });
    }
    size_t count = 0;
    for (const bool c : hasSurface) count += c;
    return atlas.texelCount() ? float(double(count) / double(atlas.texelCount())) : 0.0f;
}

AtlasStats statsOf(const Atlas& atlas, const std::vector<FlatChart>& flats, const MeshTopology& topology) {
    double area = 0, good = 0;
    for (const FlatChart& flat : flats) {
        area += flat.area;
        good += flat.area * flat.areaWithinStretch15;
    }
    AtlasStats stats;
    stats.chartCount = uint32_t(atlas.charts.size());
    stats.coverage = coverageOf(atlas);
    stats.areaWithinStretch15 = area > 0 ? float(good / area) : 1.0f;
    for (uint32_t t = 0; t < topology.faceArea.size(); ++t)
        stats.degenerateTriangles += topology.degenerate(t);
    return stats;
}

}  // namespace phat
