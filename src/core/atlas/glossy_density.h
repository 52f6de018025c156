#pragma once
// Finer texels where reflections are sharp.

#include <span>
#include <vector>

#include "core/scene/scene.h"

namespace phat {

/// Largest value of AtlasSettings::glossyDensity; 64 times the texels on the same area.
inline constexpr float kMaxGlossyDensity = 8;

/// Per surface: how many times finer than a rough surface's its texels should be (a ratio of lengths), in
/// [1, maxDensity]. Follows from the material's reflectance and roughness, textures included.
std::vector<float> glossyDensities(const Scene& scene, float maxDensity);

/// Densities for pieces of these areas under a fixed number of texels: relative to the least of them,
/// and nearer to 1 where the coarsest texels would else be more than a quarter larger than texels of one
/// size.
void keepBudget(std::span<const double> area, std::span<double> density);

}  // namespace phat
