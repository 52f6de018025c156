#pragma once
// The glTF 2.0 material model (specification, appendix B): GGX with height-correlated Smith masking and
// Schlick's Fresnel over Lambert, under an optional clear coat.
//
// All directions are unit, local (z = shading normal) and point away from the surface:
// `towardEye` is where light goes, `towardLight` where it comes from.
//
// twin: shaders/lib/brdf.glsl, same names; tests/shader compares the two.

#include <vector>

#include "core/base/math.h"

namespace phat {

/// Roughness 0 is a legal mirror; its GGX alpha is clamped to this value so that densities stay finite.
inline constexpr float kMinAlpha = 1e-3f;

/// A material evaluated at one point, textures applied.
struct Brdf {
    glm::vec3 diffuseColor{0};  // base colour * (1 - metallic) * (1 - transmission) * (1 - meanFresnel)
    glm::vec3 f0{0.04f};        // specular reflectance at normal incidence
    float f90 = 1;              // and at grazing
    float alpha = 1;            // roughness squared, >= kMinAlpha
    float clearcoat = 0;        // weight of the coat
    float clearcoatAlpha = kMinAlpha;
    glm::vec3 clearcoatNormal{0, 0, 1};  // local
    float transmission = 0;              // fraction of the dielectric base that transmits instead of Lambert
    glm::vec3 transmissionColor{0};      // transmission * (1 - metallic) * base colour
};

/// F0 of the coat (index of refraction 1.5, KHR_materials_clearcoat); its F90 is 1.
inline constexpr float kClearcoatF0 = 0.04f;

/// Mean of Schlick's (1 - v.h)^5 over cosine-weighted view and light directions, by Monte Carlo with 4e5
/// samples: f0 + (f90 - f0) * this is the mean Fresnel reflectance that the Lambert lobe loses.
/// It makes the lobe separable: F0 = .04 gives .9565 (docs/reference.md).
inline constexpr float kMeanSchlick = 0.00368f;
inline float meanFresnel(float f0, float f90) {
    return f0 + (f90 - f0) * kMeanSchlick;
}

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
/// The table itself, [sqrt(alpha)][nDotV], entry i at i / 63 of either axis; for upload to the GPU.
const std::vector<glm::vec2>& splitSumTable();

/// Scale of the Lambert lobe, 1 nearly everywhere: it holds the sum of both lobes' albedos at 1 where
/// appendix B would exceed it, min(1, (1 - max E_specular) / max diffuseColor); diffuseColor without the
/// factor 1 - transmission, since what is transmitted has its part of what the specular lobe leaves.
/// ours, because appendix B reflects up to 1.9 times the light at grazing angles (docs/reference.md).
float diffuseWeight(const Brdf& brdf, float nDotV);
/// Transmission of the clear coat to the layers below: 1 - clearcoat * E_coat(towardEye . clearcoatNormal).
float clearcoatTransmission(const Brdf& brdf, glm::vec3 towardEye);

/// Transmittance of a transmissive interface for light between `towardEye` and the other side: what the coat
/// and the specular lobe do not reflect, tinted. The three add up to 1 for white.
glm::vec3 interfaceTransmittance(const Brdf& brdf, glm::vec3 towardEye);

/// BRDF * cos(towardLight), 1/sr; zero when either direction is below the horizon.
glm::vec3 evaluateBrdf(const Brdf& brdf, glm::vec3 towardEye, glm::vec3 towardLight);
/// The two parts: Lambert, and GGX with the coat.
struct LobeValues {
    glm::vec3 diffuse{0};
    glm::vec3 specular{0};
};
LobeValues evaluateLobes(const Brdf& brdf, glm::vec3 towardEye, glm::vec3 towardLight);

/// A BRDF for one direction toward the eye, with all terms that depend on that direction alone, for several
/// calls of the functions below.
struct ViewedBrdf {
    Brdf brdf;
    glm::vec3 towardEye{0};
    float transmission = 1;      // of the coat
    glm::vec3 diffuse{0};        // Lambert's f, 1/sr
    glm::vec3 chances{0};        // of drawing Lambert, GGX, the coat; 0: nothing is reflected
    Frame coatFrame;             // local, of the coat's own normal
    glm::vec3 towardEyeCoat{0};  // in that frame
};
ViewedBrdf viewedBrdf(const Brdf& brdf, glm::vec3 towardEye);
inline bool reflects(const ViewedBrdf& viewed) {
    return viewed.chances.x + viewed.chances.y + viewed.chances.z > 0.0f;
}
/// One of its parts alone, to evaluate and to sample: Lambert; or GGX with the coat.
enum class Lobes : uint8_t { all, diffuse, glossy };
ViewedBrdf only(Lobes lobes, const ViewedBrdf& viewed);
LobeValues evaluateLobes(const ViewedBrdf& viewed, glm::vec3 towardLight);
inline glm::vec3 evaluateBrdf(const ViewedBrdf& viewed, glm::vec3 towardLight) {
    const LobeValues value = evaluateLobes(viewed, towardLight);
    return value.diffuse + value.specular;
}

/// Directional albedo of everything, the chance that a photon or a path goes on; at most 1.
glm::vec3 reflectance(const Brdf& brdf, glm::vec3 towardEye);

struct BrdfSample {
    glm::vec3 direction{0};
    glm::vec3 weight{0};  // BRDF * cos / pdf; zero when nothing was found
    float pdf = 0;        // 1/sr, of all lobes together
};
/// Samples towardLight for a given towardEye: chooses a lobe by albedo; Lambert by cosine, GGX by visible
/// normals (Heitz 2018). `lobe` in [0,1).
BrdfSample sampleBrdf(const ViewedBrdf& viewed, float lobe, glm::vec2 square);
BrdfSample sampleBrdf(const Brdf& brdf, glm::vec3 towardEye, float lobe, glm::vec2 square);
/// Density of sampleBrdf, 1/sr.
float sampleBrdfPdf(const ViewedBrdf& viewed, glm::vec3 towardLight);
float sampleBrdfPdf(const Brdf& brdf, glm::vec3 towardEye, glm::vec3 towardLight);

/// Cosine-weighted hemisphere; pdf = z / pi.
glm::vec3 squareToCosineHemisphere(glm::vec2 square);
float squareToCosineHemispherePdf(glm::vec3 direction);

/// GGX half vector among those visible from `towardEye`, and its density, 1/sr of half vectors.
glm::vec3 squareToVisibleNormal(glm::vec2 square, glm::vec3 towardEye, float alpha);
float squareToVisibleNormalPdf(glm::vec3 half, glm::vec3 towardEye, float alpha);

}  // namespace phat
