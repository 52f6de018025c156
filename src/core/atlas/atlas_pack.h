#pragma once
// Chart rectangles onto the tile grid.

#include <span>
#include <vector>

#include "core/atlas/atlas.h"
#include "core/atlas/free_tiles.h"
#include "core/atlas/piece_group.h"

namespace phat {

/// A chart's bounding box, or those of its pieces. A twin has the size of the box before it and is laid the
/// same way. Sizes are magnified by the chart's density where its texels are finer.
struct PackBox {
    glm::dvec2 sizeMeters{0};        // of a chart of one piece; x >= y
    std::vector<glm::dvec2> pieces;  // sizes, as the pieces are turned; empty if there is one alone
    bool twin = false;
};

struct Packing {
    double texelSizeMeters = 0;  // of charts of density 1
    glm::uvec2 sizeTiles{0};
    std::vector<glm::uvec2> originTile;  // per chart
    std::vector<glm::uvec2> chartTiles;  // per chart: size, gutter included
    std::vector<uint8_t> turned;         // per chart: to be laid on its side, x and y swapped
    std::vector<double> scale;           // per chart: how much finer its texels are than asked for, near 1
    std::vector<GroupLayout> layout;     // per chart: of its pieces before the chart was turned
};

/// Places the boxes so that they share no tile. The texel size is the one of
/// the settings, or else the finest whose atlas keeps within the texel budget, where a chart may be up to
/// kFillFreedom finer or coarser to fill its tiles; if even charts of next to no
/// texels exceed the budget, the atlas is larger than that.
/// Throws std::runtime_error if the charts do not fit in maxSizeTexels.
Packing packCharts(std::span<const PackBox> boxes, const AtlasSettings& settings, Progress& progress);

/// Places the boxes at `texelSizeMeters` on tiles that are free, as near to the first row as there is room;
/// the atlas gets more rows where it needs them, and more columns only for a box that is too long either
/// way. `taken`: the tiles of other charts. Throws as packCharts.
Packing packChartsAround(std::span<const PackBox> boxes, const AtlasSettings& settings,
                         double texelSizeMeters, const TakenTiles& taken);

}  // namespace phat
