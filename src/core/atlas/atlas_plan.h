#pragma once
// From flat pieces to charts with their places in the atlas.

#include <vector>

#include "core/atlas/atlas_pack.h"
#include "core/atlas/atlas_pieces.h"
#include "core/atlas/piece_group.h"

namespace phat {

/// A chart before it is packed.
struct ChartPlan {
    PieceGroup pieces;
    bool back = false;   // its texels face away from the triangles' front
    bool twin = false;   // the other side of the plan before
    double density = 1;  // texels along a length, over those of rough surfaces
};

/// The charts of groups of pieces, one or two for the sides of each.
std::vector<ChartPlan> planCharts(std::vector<PieceGroup> groups, const Pieces& pieces);

/// What packs them. `classes`: of the pieces; empty: none is small.
std::vector<PackBox> boxesOf(const Pieces& pieces, const std::vector<ChartPlan>& plans,
                             const std::vector<PieceClass>& classes);

/// The atlas of charts that are packed. Triangles that are in none of them have no chart.
Atlas placeCharts(const Scene& scene, const Pieces& pieces, const std::vector<ChartPlan>& plans,
                  const Packing& packing);

/// Sets tileChart and firstBlock from the charts' places.
void fillTileTable(Atlas& atlas);

}  // namespace phat
