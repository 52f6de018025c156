#pragma once
// From surfaces to the flat pieces that charts are made of.

#include <vector>

#include "core/atlas/atlas.h"
#include "core/atlas/mesh_topology.h"
#include "core/atlas/piece_pose.h"
#include "core/atlas/piece_views.h"
#include "core/atlas/unwrap.h"

namespace phat {

/// The flat pieces with what their charts are chosen by.
struct Pieces {
    std::vector<FlatChart> flats;
    std::vector<Sides> sides;      // per piece
    std::vector<double> density;   // per piece
    std::vector<PieceView> views;  // per piece, or empty
    double aboutTexelSizeMeters = 0;

    uint32_t surface(const Scene& scene, uint32_t piece) const {
        return scene.triangleSurface[flats[piece].triangles[0]];
    }
};

/// What pieces must have in common: those that are laid as one plane their surface, for walls divide planes
/// into surfaces; those that share a chart the node that moves them.
enum class Common { surface, node };

/// Pieces of several surfaces share a chart if their densities are nearly the same.
double commonDensity(double density, Common common);

/// Per piece.
std::vector<PieceClass> classesOf(const Scene& scene, const Pieces& pieces, Common common);

/// What buildAtlas is asked for.
struct AtlasOrder {
    const Scene& scene;
    const RayScene* rays;  // null: all pieces count as open
    const std::vector<Sides>& componentSides;
    const AtlasSettings& settings;
    double texelSizeMeters;  // of rough surfaces; 0: to be found for the budget
    // Per triangle, how fine texels are where others of that size are there already; null: as the budget
    // asks.
    const std::vector<double>* farDensity = nullptr;
};

/// The pieces of the triangles that are not degenerate in `topology`.
Pieces makePieces(const AtlasOrder& order, const MeshTopology& topology, Progress& progress);

}  // namespace phat
