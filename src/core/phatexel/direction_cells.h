#pragma once
// Directions and the cells of a block's histogram (Guide) that they lie in.

#include "core/phatexel/phatexture.h"

namespace phat {

inline constexpr float kCellsPerSteradian = float(kGuideCells) / (2.0f * kPi);

/// Photons and texels whose normals are further apart belong to different surfaces.
inline constexpr float kMinNormalCosine = 0.5f;

/// Cell of a direction of the upper hemisphere, [y][x] as in Guide.
int cellOfDirection(glm::vec3 direction);

/// A point of the cell: `inCell` in [0,1)^2, spread evenly over its solid angle.
glm::vec3 directionInCell(int cell, glm::vec2 inCell);

/// Mean cosine over the cell's solid angle.
float meanCosine(int cell);

/// The direction that packPhatexel can hold, near enough to `direction` to keep clear of its cell's border:
/// the density is read back from the cell, and a neighbour's may be a hundred times less.
glm::vec3 storableDirection(glm::vec3 direction);

}  // namespace phat
