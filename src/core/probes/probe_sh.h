#pragma once
// Irradiance as a function of the normal: spherical harmonics up to order 2. source: Ramamoorthi and Hanrahan
// 2001, "An Efficient Representation for Irradiance Environment Maps".

#include <array>
#include <cstdint>

#include "core/base/math.h"

namespace phat {

inline constexpr int kShTerms = 9;

/// Polynomials of a unit vector that span the spherical harmonics up to order 2:
/// 1, x, y, z, (3 z^2 - 1) / 2, x^2 - y^2, x y, y z, z x.
std::array<float, kShTerms> shTerms(glm::vec3 direction);

/// Irradiance by normal n: the sum of coefficient[i] * shTerms(n)[i], W/m2. The first is the mean over all
/// normals.
struct IrradianceSh {
    std::array<glm::vec3, kShTerms> coefficient{};

    /// Adds the irradiance by light of `radianceSolidAngle` (W/m2 on a plane that faces it) that arrives from
    /// a unit direction: the clamped cosine up to order 2.
    void addLight(glm::vec3 direction, glm::vec3 radianceSolidAngle);
    /// With beyondOrder2; at least 0, which is a clamp.
    glm::vec3 at(glm::vec3 normal) const;
    /// What the orders above 2 add if all light comes from around one direction: those of the clamped cosine,
    /// times the cube of the mean P2 of the light's angles to its main direction. That mean is 1 for one
    /// direction, 0 for a hemisphere, and its cube is near the mean P4 of a cap, on which the next order
    /// depends (.53 and .45 for one of 30 degrees, .86 and .84 for 15). Zero where the light has no main
    /// direction. ours.
    glm::vec3 beyondOrder2(glm::vec3 normal) const;
};

/// 28 bytes: the mean as RGB9E5, then the others over the mean, a signed byte each, in the order of the terms
/// and within one red, green, blue; 127 is the largest ratio that light can have (shRatioBound).
using PackedIrradianceSh = std::array<uint32_t, 7>;

/// The largest ratio of the other coefficients to the mean, which light from one direction has.
float shRatioBound(int term);
/// pre: of light that is nowhere negative, so that no ratio exceeds its bound.
PackedIrradianceSh packIrradianceSh(const IrradianceSh& irradiance);
IrradianceSh unpackIrradianceSh(const PackedIrradianceSh& packed);

}  // namespace phat
