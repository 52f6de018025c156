#pragma once
// Finer texels where reflections are sharp.

#include <span>
#include <vector>

#include "core/scene.h"

namespace phat {

/// Largest value of AtlasSettings::glossyDensity; 64 times the texels on the same area.
inline constexpr float kMostGlossyDensity = 8;

/// Per surface: how many times finer than a rough surface's its texels should be (a ratio of lengths), in
/// [1, maxDensity]. Follows from the material's reflectance and roughness, textures included.
std::vector<float> glossyDensities(const Scene& scene, float maxDensity);

/// Brings densities nearer to 1 so far that a fixed number of texels, spread over pieces of these areas,
/// makes the texels of density 1 at most a quarter larger than if all were of density 1.
void keepBudget(std::span<const double> area, std::span<double> density);

}  // namespace phat
