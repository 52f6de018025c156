#pragma once
// The glTF 2.0 material model (specification, appendix B): GGX with height-correlated Smith masking and
// Schlick's Fresnel over Lambert, under an optional clear coat.
//
// All directions are unit, local (z = shading normal) and point away from the surface:
// `towardEye` is where light goes, `towardLight` where it comes from.
//
// twin: shaders/lib/brdf.glsl, same names; tests/shader compares the two.

#include "core/math.h"
#include <vector>

namespace phat {

/// Roughness 0 is a legal mirror; its GGX alpha is held at this value so that densities stay finite.
inline constexpr float kMinAlpha = 1e-3f;

/// What a material is at one point, textures applied.
struct Brdf {
    glm::vec3 diffuseColor{0};  // base colour * (1 - metallic)
    glm::vec3 f0{0.04f};        // specular reflectance at normal incidence
    float f90 = 1;              // and at grazing
    float alpha = 1;            // roughness squared, >= kMinAlpha
    float clearcoat = 0;        // weight of the coat (F0 = .04)
    float clearcoatAlpha = kMinAlpha;
};

/// GGX distribution of microfacet normals, 1/sr.
float ggxD(float nDotH, float alpha);
/// Height-correlated Smith masking-shadowing over 4 (n.l)(n.v): f_specular = F * D * V.
float smithV(float nDotL, float nDotV, float alpha);
/// Masking of one direction.
float smithG1(float nDotV, float alpha);
/// Schlick's approximation.
glm::vec3 schlick(glm::vec3 f0, float f90, float vDotH);

/// Directional albedo of the specular lobe as f0 * x + f90 * y: the "split sum" (Karis 2013),
/// bilinear in a 64x64 table over (nDotV, sqrt(alpha)), integrated at first use to within 2e-3.
glm::vec2 splitSum(float nDotV, float alpha);
glm::vec3 specularAlbedo(glm::vec3 f0, float f90, float alpha, float nDotV);
inline constexpr int kSplitSumSize = 64;
/// The table itself, [alpha][nDotV], texel centres at (i + .5) / 64; for upload to the GPU.
const std::vector<glm::vec2>& splitSumTable();

/// Weight of the Lambert lobe: 1 - mean Fresnel, and never more than the specular lobe leaves over.
/// ours: appendix B's 1 - F(v.h) is not separable and exceeds albedo 1 at grazing angles (docs/pipeline.md).
float diffuseWeight(const Brdf& brdf, float nDotV);
/// What the clear coat lets through to the layers below.
float clearcoatTransmission(const Brdf& brdf, float nDotV);

/// BRDF * cos(towardLight), 1/sr; zero when either direction is below the horizon.
glm::vec3 evaluateBrdf(const Brdf& brdf, glm::vec3 towardEye, glm::vec3 towardLight);
/// The two parts: Lambert, and GGX with the coat.
struct LobeValues {
    glm::vec3 diffuse{0};
    glm::vec3 specular{0};
};
LobeValues evaluateLobes(const Brdf& brdf, glm::vec3 towardEye, glm::vec3 towardLight);

/// Directional albedo of everything, the chance that a photon or a path goes on.
glm::vec3 reflectance(const Brdf& brdf, float nDotV);

struct BrdfSample {
    glm::vec3 direction{0};
    glm::vec3 weight{0};  // BRDF * cos / pdf; zero when nothing was found
    float pdf = 0;        // 1/sr, of all lobes together
};
/// Draws towardLight for a given towardEye: chooses a lobe by albedo; Lambert by cosine, GGX by visible
/// normals (Heitz 2018). `lobe` in [0,1).
BrdfSample sampleBrdf(const Brdf& brdf, glm::vec3 towardEye, float lobe, glm::vec2 square);
/// Density of sampleBrdf, 1/sr.
float sampleBrdfPdf(const Brdf& brdf, glm::vec3 towardEye, glm::vec3 towardLight);

/// Cosine-weighted hemisphere; pdf = z / pi.
glm::vec3 squareToCosineHemisphere(glm::vec2 square);
float squareToCosineHemispherePdf(glm::vec3 direction);

/// GGX half vector among those visible from `towardEye`, and its density, 1/sr of half vectors.
glm::vec3 squareToVisibleNormal(glm::vec2 square, glm::vec3 towardEye, float alpha);
float squareToVisibleNormalPdf(glm::vec3 half, glm::vec3 towardEye, float alpha);

}  // namespace phat
