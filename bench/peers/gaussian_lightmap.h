#pragma once
// A lightmap whose texels hold nine spherical gaussians of incident light.
// source: Neubelt and Pettineo 2015, "Advanced Lighting R&D at Ready At Dawn Studios"; Pettineo 2016,
// "SG Series" (the reading of it as a glossy surface).

#include <array>
#include <vector>

#include "core/atlas/atlas.h"
#include "core/base/progress.h"
#include "core/scene/lights.h"
#include "core/scene/shading.h"
#include "core/transport/path.h"

namespace phat::peers {

inline constexpr int kGaussians = 9;
inline constexpr int kGaussianTexelBytes = 4 * kGaussians;  // RGB9E5 each

/// G(w) = amplitude * exp(sharpness * (dot(axis, w) - 1)), the axes spread over the hemisphere around +z.
struct GaussianBasis {
    std::array<glm::vec3, kGaussians> axis;
    float sharpness = 1;
    std::array<std::array<float, kGaussians>, kGaussians> products;  // integrals of G_i G_j over it, sr
};
GaussianBasis hemisphereGaussians();

using Amplitudes = std::array<glm::vec3, kGaussians>;

/// Amplitudes >= 0 of the least squares fit to a radiance of which `moments` holds the integrals with each
/// gaussian, W/m2.
Amplitudes fitGaussians(const GaussianBasis& basis, const Amplitudes& moments);

/// Radiance of the fit along a local direction.
glm::vec3 gaussianRadiance(const GaussianBasis& basis, const Amplitudes& amplitudes, glm::vec3 direction);

struct GaussianLightmap {
    GaussianBasis basis;
    Atlas atlas;
    TexelPoints points;
    std::vector<Amplitudes> texels;  // [y][x], around the texels' normals and tangents
    uint64_t texelCount = 0;         // that carry light
};

struct GaussianSettings {
    float texelSizeMeters = 0.01f;
    int raysPerTexel = 144;
    PathSettings paths;
    uint64_t seed = 1;
};

/// Bakes the light that was reflected at least once onto the charts of one material, in an atlas of its own.
GaussianLightmap bakeGaussians(const RayScene& rays, const LightSampler& lights, uint32_t material,
                               const GaussianSettings& settings, Progress& progress);

/// How the BRDF is applied to the gaussians.
enum class GaussianReading : uint8_t {
    warped,  // as engines do: GGX's normals as a gaussian, warped to directions, times each gaussian in
             // closed form
    exact,   // by many samples of the BRDF
};

glm::vec3 shadeByGaussians(const GaussianLightmap& lightmap, const Hit& hit, const SurfacePoint& point,
                           glm::vec3 towardEye, GaussianReading reading);

}  // namespace phat::peers
