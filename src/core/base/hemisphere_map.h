#pragma once
// Equal-area map between the unit square and the hemisphere around +z.
//
// Guidance histograms live in the square: equal cells are equal solid angles, so a cell's
// probability divided by its solid angle is the pdf, with no Jacobian to forget.
//
// source: Shirley and Chiu 1997, "A Low Distortion Map Between Disk and Square" (square to disk),
//         then Lambert's azimuthal projection (disk to hemisphere).
// twin:   shaders/lib/hemisphere_map.glsl, same names; tests/shader compares the two.

#include "core/base/math.h"

namespace phat {

/// Square [0,1]^2 to unit direction with z >= 0. Equal areas map to equal solid angles.
glm::vec3 squareToHemisphere(glm::vec2 square);

/// Density of squareToHemisphere, in 1/sr: 1/(2 pi) above the horizon, 0 below.
float squareToHemispherePdf(glm::vec3 direction);

/// Inverse of squareToHemisphere. pre: |direction| = 1, direction.z >= 0.
glm::vec2 hemisphereToSquare(glm::vec3 direction);

}  // namespace phat
