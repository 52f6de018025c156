#include "gl/bvh_opacity.h"

#include <bit>

namespace phat {
namespace {

constexpr uint32_t kNearestTexel = 16, kHasPicture = 32, kIsMasked = 64;
constexpr uint32_t kNoPicture = ~0u;

uint32_t bitsOf(float x) {
    return std::bit_cast<uint32_t>(x);
}

void addTriangle(OpacityTables& tables, const Scene& scene, uint32_t triangle) {
    const glm::uvec3 t = scene.triangles[triangle];
    const uint32_t material = scene.surfaces[scene.triangleSurface[triangle]].material;
    const auto& uvs = scene.materials[material].baseColorTexture.uvSet == 0 ? scene.uv0 : scene.uv1;
    const glm::vec2 a = uvs[t.x], b = uvs[t.y], c = uvs[t.z];
    tables.texels.push_back({bitsOf(a.x), bitsOf(a.y), bitsOf(b.x), bitsOf(b.y)});
    tables.texels.push_back({bitsOf(c.x), bitsOf(c.y), triangle, material});
    tables.texels.push_back(
        {bitsOf(scene.colors[t.x].a), bitsOf(scene.colors[t.y].a), bitsOf(scene.colors[t.z].a), 0});
}

void addMaterial(OpacityTables& tables, const Scene& scene, const Material& material,
                 std::vector<uint32_t>& firstTexel) {
    const TextureSlot& slot = material.baseColorTexture;
    uint32_t flags = uint32_t(material.alphaMode == AlphaMode::mask ? kIsMasked : 0) |
                     (slot.nearest ? kNearestTexel : 0) | uint32_t(slot.wrapU) | uint32_t(slot.wrapV) << 2;
    glm::uvec2 size(0);
    uint32_t first = 0;
    const bool hasPicture = slot.image >= 0 && !scene.images[size_t(slot.image)]->texels.empty();
    if (material.alphaMode != AlphaMode::opaque && hasPicture) {
        const TextureImage& image = *scene.images[size_t(slot.image)];
        uint32_t& known = firstTexel[size_t(slot.image)];
        if (known == kNoPicture) {
            known = uint32_t(tables.alphas.size());
            for (const glm::u8vec4 texel : image.texels) tables.alphas.push_back(texel.a);
        }
        first = known;
        size = glm::uvec2(image.width, image.height);
        flags |= kHasPicture;
    }
    const glm::mat3x2& m = slot.uvTransform;
    tables.texels.push_back({bitsOf(material.baseColor.a), bitsOf(material.alphaCutoff), first, flags});
    tables.texels.push_back({size.x, size.y, bitsOf(m[2].x), bitsOf(m[2].y)});
    tables.texels.push_back({bitsOf(m[0].x), bitsOf(m[1].x), bitsOf(m[0].y), bitsOf(m[1].y)});
}

}  // namespace

OpacityTables opacityTables(const Scene& scene, const SceneBvh& bvh) {
    OpacityTables tables;
    for (uint32_t i = bvh.firstTransparent; i < bvh.order.size(); ++i)
        addTriangle(tables, scene, bvh.order[i]);
    tables.firstMaterial = uint32_t(tables.texels.size());
    std::vector<uint32_t> firstTexel(scene.images.size(), kNoPicture);
    for (const Material& material : scene.materials) addMaterial(tables, scene, material, firstTexel);
    return tables;
}

}  // namespace phat
