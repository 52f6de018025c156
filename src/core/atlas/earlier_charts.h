#pragma once
// An atlas that keeps the charts of an earlier one.
//
// What is as it was stays where it was, so that a scene that is changed and baked again has its texels in the
// same places, and only what is new is unwrapped. A surface is kept with all its charts or not at all.

#include <span>
#include <vector>

#include "core/atlas/atlas.h"

namespace phat {

inline constexpr uint32_t kNewSurface = ~0u;

/// Sides of a connected piece of surface that have to have texels.
struct NeededSides {
    bool front = false, back = false;
};

/// The atlas of an earlier bake of a scene.
struct EarlierCharts {
    const Atlas& atlas;
    std::span<const Surface> surfaces;     // of the earlier scene
    std::vector<uint32_t> earlierSurface;  // per surface of the scene: the same one of the earlier scene, of
                                           // the same shape and size, or kNewSurface; none is named twice
    std::vector<NeededSides> needed = {};  // per component; empty: those that it is built for
};

/// Which surfaces of the scene keep their charts: those whose charts have all sides that are needed, and all
/// of whose surfaces are kept and still of one node. Charts may have sides that are dark now.
std::vector<bool> keptSurfaces(const Scene& scene, const std::vector<Sides>& componentSides,
                               const EarlierCharts& earlier);

/// As buildAtlas. Kept charts stay where they are, with their texels' sizes; they come first, in their order.
/// All others are made for texels of the size that rough surfaces near the middle of the scene have among the
/// kept ones, and placed where tiles are free. `stats` of the unwrapping are of these alone. If nothing is
/// kept, it is an atlas of its own.
Atlas buildAtlasOn(const EarlierCharts& earlier, const RayScene& rays,
                   const std::vector<Sides>& componentSides, const AtlasSettings& settings,
                   Progress& progress, AtlasStats* stats = nullptr);

}  // namespace phat
