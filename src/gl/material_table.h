#pragma once
// A material as rows of four floats. twin: shaders/lib/material.glsl.

#include <array>
#include <vector>

#include "core/scene/scene.h"

namespace phat {

inline constexpr int kFactorRows = 7;
inline constexpr int kSlotCount = 11;
/// The first slots, which all surfaces have; the others are those of glass.
inline constexpr int kOpaqueSlots = 9;
inline constexpr int kMaterialRows = kFactorRows + 2 * kSlotCount;

/// The texture slots in the order of the rows, with the sampler each feeds.
struct NamedSlot {
    const char* sampler;
    const TextureSlot Material::*slot;
    bool srgb;
};
inline constexpr std::array<NamedSlot, kSlotCount> kSlots = {{
    {"baseColorTexture", &Material::baseColorTexture, true},
    {"metallicRoughnessTexture", &Material::metallicRoughnessTexture, false},
    {"normalTexture", &Material::normalTexture, false},
    {"emissionTexture", &Material::emissionTexture, true},
    {"specularTexture", &Material::specularTexture, false},
    {"specularColorTexture", &Material::specularColorTexture, true},
    {"clearcoatTexture", &Material::clearcoatTexture, false},
    {"clearcoatRoughnessTexture", &Material::clearcoatRoughnessTexture, false},
    {"clearcoatNormalTexture", &Material::clearcoatNormalTexture, false},
    {"transmissionTexture", &Material::transmissionTexture, false},
    {"thicknessTexture", &Material::thicknessTexture, false},
}};

/// `metersPerUnit`: of its thickness.
std::array<glm::vec4, kMaterialRows> packMaterial(const Material& material, float metersPerUnit = 1);

/// The factor rows of all materials, one after the other.
std::vector<glm::vec4> packFactors(const std::vector<Material>& materials);

}  // namespace phat
