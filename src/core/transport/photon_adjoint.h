#pragma once
// The adjoint BRDF for photons: light is traced forward while the BRDF is defined from the eye.

#include "core/scene/brdf.h"

namespace phat {

/// BRDF that light arriving along `towardLight` meets on its way to `towardEye` (both local), per unit of
/// flux density on the *geometric* surface: f cos_s / cos_g. The cosines differ where normals are
/// interpolated or mapped. source: Veach 1997, section 5.3. The ratio of the cosines has no bound, and a
/// photon so heavy is a firefly: clamped to 4. A bias, on light that grazes the true surface and not
/// the shaded one. ours.
inline glm::vec3 perArrivingFlux(const Brdf& brdf, glm::vec3 towardEye, glm::vec3 towardLight,
                                 float cosGeometric) {
    constexpr float kMaxCosineRatio = 4.0f;
    const float cosine = std::max(cosGeometric, towardLight.z / kMaxCosineRatio);
    return cosine > 0 ? evaluateBrdf(brdf, towardEye, towardLight) / cosine : glm::vec3(0);
}

}  // namespace phat
