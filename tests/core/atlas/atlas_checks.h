#pragma once
// What holds for every atlas, checked by brute force without the product's own rasteriser.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/atlas/atlas.h"

namespace phat {

inline double areaOf(const Scene& scene, uint32_t triangle) {
    const glm::uvec3& v = scene.triangles[triangle];
    const glm::dvec3 a = scene.positions[v[0]], b = scene.positions[v[1]], c = scene.positions[v[2]];
    return 0.5 * glm::length(glm::cross(b - a, c - a));
}

inline double texelAreaOf(const Atlas& atlas, uint32_t triangle) {
    const auto& t = atlas.triangleTexels[triangle];
    const glm::dvec2 e1 = t[1] - t[0], e2 = t[2] - t[0];
    return 0.5 * (e1.x * e2.y - e1.y * e2.x);
}

/// The 2x2 metric of the map texels -> metres, over the chart's texel size, by its singular values.
inline glm::dvec2 singularValues(const Scene& scene, const Atlas& atlas, uint32_t triangle) {
    const glm::uvec3& v = scene.triangles[triangle];
    const auto& t = atlas.triangleTexels[triangle];
    const double texelSize = double(atlas.charts[atlas.triangleChart[triangle]].texelSizeMeters);
    const glm::dmat2 inverse = glm::inverse(glm::dmat2(glm::dvec2(t[1] - t[0]), glm::dvec2(t[2] - t[0])));
    const glm::dvec3 e1 = scene.positions[v[1]] - scene.positions[v[0]],
                     e2 = scene.positions[v[2]] - scene.positions[v[0]];
    const glm::dvec3 dx = (inverse[0][0] * e1 + inverse[0][1] * e2) / texelSize;
    const glm::dvec3 dy = (inverse[1][0] * e1 + inverse[1][1] * e2) / texelSize;
    const double a = glm::dot(dx, dx), b = glm::dot(dx, dy), c = glm::dot(dy, dy);
    const double mean = 0.5 * (a + c), spread = std::sqrt(0.25 * (a - c) * (a - c) + b * b);
    return {std::sqrt(std::max(0.0, mean - spread)), std::sqrt(mean + spread)};
}

/// Tiles belong to the charts' rectangles and to nothing else; corners stay in them; no centre of a texel
/// is well inside two triangles; every usable triangle has a chart of its own surface.
inline void expectSoundAtlas(const Scene& scene, const Atlas& atlas, const AtlasSettings& settings) {
    ASSERT_EQ(atlas.triangleChart.size(), scene.triangles.size());
    // Between the finest and the coarsest of charts that are asked to be alike.
    const double freedom = settings.texelSizeMeters > 0 ? 1.0 : kFillFreedom * kFillFreedom;
    std::vector<uint32_t> tileOwner(atlas.tileChart.size(), kNoChart);
    uint32_t blocks = 0;
    for (uint32_t c = 0; c < atlas.charts.size(); ++c) {
        const Chart& chart = atlas.charts[c];
        EXPECT_EQ(chart.firstBlock, blocks);
        EXPECT_LE(chart.texelSizeMeters, atlas.texelSizeMeters);
        EXPECT_GE(chart.texelSizeMeters * settings.glossyDensity * freedom, 0.9999 * atlas.texelSizeMeters);
        blocks += chart.blocksWide() * chart.blocksHigh();
        for (uint32_t y = 0; y < chart.sizeTiles.y; ++y) {
            for (uint32_t x = 0; x < chart.sizeTiles.x; ++x) {
                const glm::uvec2 tile = chart.originTile + glm::uvec2(x, y);
                ASSERT_TRUE(tile.x < atlas.sizeTiles().x && tile.y < atlas.sizeTiles().y);
                uint32_t& owner = tileOwner[tile.y * atlas.sizeTiles().x + tile.x];
                ASSERT_EQ(owner, kNoChart) << "tile with two charts";
                owner = c;
            }
        }
    }
    EXPECT_EQ(tileOwner, atlas.tileChart);
    EXPECT_EQ(atlas.blockCount, blocks);

    std::vector<uint32_t> texelOwner(atlas.texelCount(), ~0u);
    uint32_t doubles = 0;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        if (atlas.triangleChart[t] == kNoChart) {
            EXPECT_LT(areaOf(scene, t), 1e-9);
            continue;
        }
        const Chart& chart = atlas.charts[atlas.triangleChart[t]];
        EXPECT_EQ(scene.surfaces[chart.surface].node, scene.surfaces[scene.triangleSurface[t]].node);
        const glm::vec2 low = glm::vec2(chart.originTexel()) - 1e-2f;
        const glm::vec2 high = glm::vec2(chart.originTexel() + chart.sizeTexels()) + 1e-2f;
        const auto& corner = atlas.triangleTexels[t];
        glm::vec2 boxLow(1e30f), boxHigh(-1e30f);
        for (const glm::vec2& p : corner) {
            ASSERT_TRUE(glm::all(glm::greaterThanEqual(p, low)) && glm::all(glm::lessThanEqual(p, high)))
                << "triangle " << t << " leaves its chart";
            boxLow = glm::min(boxLow, p);
            boxHigh = glm::max(boxHigh, p);
        }
        const double doubleArea = 2 * texelAreaOf(atlas, t);
        // Float coordinates may flatten a sliver, but never turn it over.
        ASSERT_GT(doubleArea, -1e-3);
        for (int y = int(boxLow.y); y <= int(boxHigh.y); ++y) {
            for (int x = int(boxLow.x); x <= int(boxHigh.x); ++x) {
                const glm::dvec2 p(x + 0.5, y + 0.5);
                bool inside = true;
                for (int i = 0; i < 3; ++i) {
                    const glm::dvec2 a = corner[i], edge = glm::dvec2(corner[(i + 1) % 3]) - a, to = p - a;
                    // A hundredth of a texel inside: shared edges are nobody's concern here.
                    inside &= edge.x * to.y - edge.y * to.x > 0.01 * glm::length(edge);
                }
                if (!inside) continue;
                uint32_t& owner = texelOwner[size_t(y) * atlas.sizeTexels.x + x];
                doubles += owner != ~0u;
                owner = t;
            }
        }
    }
    EXPECT_EQ(doubles, 0u) << "texels inside two triangles";
}

/// Fraction of the area whose stretch is at most `limit`.
inline double fractionWithinStretch(const Scene& scene, const Atlas& atlas, double limit) {
    double good = 0, total = 0;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        if (atlas.triangleChart[t] == kNoChart) continue;
        const glm::dvec2 s = singularValues(scene, atlas, t);
        total += areaOf(scene, t);
        if (s.x >= 1 / limit && s.y <= limit) good += areaOf(scene, t);
    }
    return good / total;
}

inline double surfaceArea(const Scene& scene) {
    double area = 0;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) area += areaOf(scene, t);
    return area;
}

}  // namespace phat
