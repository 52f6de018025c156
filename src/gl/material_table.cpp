#include "gl/material_table.h"

#include <algorithm>

#include "core/scene/transparency.h"

namespace phat {

std::array<glm::vec4, kMaterialRows> packMaterial(const Material& m, float metersPerUnit) {
    std::array<glm::vec4, kMaterialRows> rows{};
    rows[0] = m.baseColor;
    rows[1] = {m.emission, m.normalScale};
    rows[2] = {m.metallic, m.roughness, m.specular, m.ior};
    rows[3] = {m.specularColor, m.alphaCutoff};
    rows[4] = {m.clearcoat, m.clearcoatRoughness, m.clearcoatNormalScale, m.unlit ? 1.0f : 0.0f};
    rows[5] = {isGlass(m) ? m.transmission : 0.0f, m.thickness * metersPerUnit, 1.0f / m.attenuationDistance,
               0.0f};
    rows[6] = {m.attenuationColor, 0.0f};
    for (int i = 0; i < kSlotCount; ++i) {
        const TextureSlot& slot = m.*kSlots[i].slot;
        const glm::mat3x2& t = slot.uvTransform;
        rows[kFactorRows + 2 * i] = {t[0].x, t[1].x, t[2].x, float(slot.uvSet)};
        rows[kFactorRows + 2 * i + 1] = {t[0].y, t[1].y, t[2].y, slot.image >= 0 ? 1.0f : 0.0f};
    }
    return rows;
}

std::vector<glm::vec4> packFactors(const std::vector<Material>& materials) {
    std::vector<glm::vec4> table;
    table.reserve(materials.size() * kFactorRows);
    for (const Material& material : materials) {
        const auto rows = packMaterial(material);
        table.insert(table.end(), rows.begin(), rows.begin() + kFactorRows);
    }
    return table;
}

}  // namespace phat
