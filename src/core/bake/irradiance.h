#pragma once
// View-independent light: irradiance per texel.

#include <vector>

#include "core/atlas/atlas.h"
#include "core/base/resumable_task.h"
#include "core/transport/path.h"

namespace phat {

/// [y][x] of the atlas, W/m2 on the texel's plane. Invalid texels are filled from valid neighbours of their
/// chart, so that bilinear lookups inside a chart never meet a hole.
using IrradianceMap = std::vector<glm::vec3>;

/// Some of an atlas's charts, 1 each; empty: all.
using ChartSet = std::vector<uint8_t>;
inline bool hasChart(const ChartSet& set, uint32_t chart) {
    return set.empty() || (chart != kNoChart && set[chart] != 0);
}

/// 1 for the texels that receive light for their surroundings: those on the surface, and in charts that have
/// none of them the gutters. Other gutters float past an edge, often behind a wall, and take their irradiance
/// from these.
std::vector<uint8_t> irradianceTexels(const Atlas& atlas, const TexelPoints& points);

/// The texels that irradiance is known at.
struct ReceiverTexels {
    const Atlas& atlas;
    const TexelPoints& points;
    const std::vector<uint8_t>& receives;  // [y][x], of irradianceTexels; the others are filled from these
};

/// Removes the noise of area-light estimates and keeps their shadow edges: each texel averages those of its
/// 7x7 neighbours in the chart that differ from it by no more than both estimates' standard errors explain.
/// Other charts than `charts` are zero. `filtered` becomes the result.
ResumableTask filterAreaIrradiance(const std::vector<IrradianceEstimate>& estimates, ReceiverTexels texels,
                                   const ChartSet& charts, IrradianceMap& filtered, uint64_t sliceWork);

}  // namespace phat
