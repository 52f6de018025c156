#include "core/atlas/atlas_plan.h"

#include <cmath>
#include <optional>

namespace phat {

std::vector<ChartPlan> planCharts(std::vector<PieceGroup> groups, const Pieces& pieces) {
    std::vector<ChartPlan> plans;
    for (PieceGroup& group : groups) {
        const uint32_t first = group[0].flat;
        const Common common = group.size() > 1 ? Common::node : Common::surface;
        ChartPlan plan{std::move(group), pieces.sides[first] == Sides::back, false,
                       commonDensity(pieces.density[first], common)};
        plans.push_back(plan);
        if (pieces.sides[first] != Sides::both) continue;
        plan.back = plan.twin = true;
        plans.push_back(std::move(plan));
    }
    return plans;
}

std::vector<PackBox> boxesOf(const Pieces& pieces, const std::vector<ChartPlan>& plans,
                             const std::vector<PieceClass>& classes) {
    std::vector<PackBox> boxes;
    for (const ChartPlan& plan : plans) {
        PackBox box;
        box.twin = plan.twin;
        const uint32_t first = plan.pieces[0].flat;
        const glm::dvec2 size = pieces.flats[first].sizeMeters;
        const bool large = classes.empty() || isLargePiece(size / classes[first].texelSizeMeters);
        if (plan.pieces.size() == 1 && large)
            box.sizeMeters = plan.density * size;
        else
            for (const LaidPiece& piece : plan.pieces)
                box.pieces.push_back(plan.density *
                                     turnedSize(pieces.flats[piece.flat].sizeMeters, piece.turns));
        boxes.push_back(std::move(box));
    }
    return boxes;
}

namespace {

// Where a chart's low corner sits in its rectangle: centred, edges on texel borders; a chart narrower than a
// texel on a texel's centre, so that it has surface texels at all.
double offsetOf(double sizeTexels, uint32_t roomTexels) {
    const double offset = std::floor(0.5 * (double(roomTexels) - sizeTexels) + 1e-4);
    return sizeTexels < 1 ? offset + 0.5 - 0.5 * sizeTexels : offset;
}

struct PiecePlace {
    glm::uvec2 origin, size;          // texels
    std::optional<glm::dvec2> drawn;  // its size there, texels; as in the world if it is alone
};

// Where piece `i` of a chart has its place, gutter included.
PiecePlace placeOfPiece(const Chart& chart, const GroupLayout& layout, size_t i, bool turned) {
    if (layout.origin.empty()) return {chart.originTexel(), chart.sizeTexels(), {}};
    const glm::uvec2 origin = layout.origin[i], size = layout.size[i];
    const glm::dvec2 drawn = layout.drawn[i];
    if (!turned) return {chart.originTexel() + origin, size, drawn};
    const uint32_t height = layout.sizeTiles.y * kTileSize;
    return {chart.originTexel() + glm::uvec2(height - origin.y - size.y, origin.x),
            {size.y, size.x},
            glm::dvec2(drawn.y, drawn.x)};
}

void placePiece(Atlas& atlas, const FlatChart& flat, uint32_t chartIndex, uint32_t turns,
                const PiecePlace& place) {
    glm::dvec2 scale(1.0 / atlas.charts[chartIndex].texelSizeMeters);
    const glm::dvec2 size = scale * turnedSize(flat.sizeMeters, turns);
    glm::dvec2 low(offsetOf(size.x, place.size.x), offsetOf(size.y, place.size.y));
    if (place.drawn) {
        scale *= *place.drawn / glm::max(size, 1e-300);
        low = drawnOrigin(*place.drawn, place.size);
    }
    low += glm::dvec2(place.origin);
    for (size_t t = 0; t < flat.triangles.size(); ++t) {
        atlas.triangleChart[flat.triangles[t]] = chartIndex;
        for (int corner = 0; corner < 3; ++corner)
            atlas.triangleTexels[flat.triangles[t]][corner] =
                glm::vec2(low + scale * turnedPosition(flat.uvMeters[t][corner], flat.sizeMeters, turns));
    }
}

}  // namespace

void fillTileTable(Atlas& atlas) {
    atlas.tileChart.assign(size_t(atlas.sizeTiles().x) * atlas.sizeTiles().y, kNoChart);
    for (uint32_t c = 0; c < atlas.charts.size(); ++c) {
        const Chart& chart = atlas.charts[c];
        for (uint32_t y = 0; y < chart.sizeTiles.y; ++y)
            for (uint32_t x = 0; x < chart.sizeTiles.x; ++x)
                atlas.tileChart[size_t(chart.originTile.y + y) * atlas.sizeTiles().x + chart.originTile.x +
                                x] = c;
    }
    numberBlocks(atlas);
}

Atlas placeCharts(const Scene& scene, const Pieces& pieces, const std::vector<ChartPlan>& plans,
                  const Packing& packing) {
    Atlas atlas;
    atlas.sizeTexels = packing.sizeTiles * kTileSize;
    atlas.texelSizeMeters = plans.empty() ? float(packing.texelSizeMeters) : 0.0f;
    atlas.triangleChart.assign(scene.triangles.size(), kNoChart);
    atlas.triangleSurface = scene.triangleSurface;
    atlas.triangleTexels.assign(scene.triangles.size(), {});
    for (uint32_t c = 0; c < plans.size(); ++c) {
        const ChartPlan& plan = plans[c];
        Chart chart;
        chart.originTile = packing.originTile[c];
        chart.sizeTiles = packing.chartTiles[c];
        chart.texelSizeMeters = float(packing.texelSizeMeters / (plan.density * packing.scale[c]));
        atlas.texelSizeMeters = std::max(atlas.texelSizeMeters, chart.texelSizeMeters);
        chart.surface = pieces.surface(scene, plan.pieces[0].flat);
        chart.back = plan.back;
        if (plan.twin) {
            chart.otherSide = c - 1;
            atlas.charts[c - 1].otherSide = c;
        }
        atlas.charts.push_back(chart);
        if (plan.twin) continue;
        for (size_t i = 0; i < plan.pieces.size(); ++i)
            placePiece(atlas, pieces.flats[plan.pieces[i].flat], c, plan.pieces[i].turns + packing.turned[c],
                       placeOfPiece(chart, packing.layout[c], i, packing.turned[c]));
    }
    fillTileTable(atlas);
    return atlas;
}

}  // namespace phat
