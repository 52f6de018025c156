#pragma once

#include "core/atlas/atlas.h"
#include "core/base/progress.h"
#include "core/render/irradiance_terms.h"
#include "core/scene/lit_scene.h"

namespace phat {

/// Irradiance of the punctual lights straight from them, W/m2, with shadows by rays: per texel the mean over
/// kPunctualPoints points of its surface. [y][x] of the atlas; texels without a surface have the light of
/// those around them (fillWithinCharts). `points`: which texels are occluded; those have none of their own.
/// `terms`, if given: gets the light by its directions, unscaled.
std::vector<glm::vec3> punctualIrradiance(const LitScene& scene, const Atlas& atlas,
                                          const TexelPoints& points, Progress& progress,
                                          IrradianceTerms* terms = nullptr);

/// In a grid over the texel, so that shadows are filtered by its square.
inline constexpr uint32_t kPunctualPointsPerSide = 4;
inline constexpr uint32_t kPunctualPoints = kPunctualPointsPerSide * kPunctualPointsPerSide;

}  // namespace phat
