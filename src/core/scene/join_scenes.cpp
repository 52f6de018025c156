#include "core/scene/join_scenes.h"

namespace phat {
namespace {

constexpr TextureSlot Material::*kTextures[] = {
    &Material::baseColorTexture,    &Material::metallicRoughnessTexture,  &Material::normalTexture,
    &Material::emissionTexture,     &Material::specularTexture,           &Material::specularColorTexture,
    &Material::clearcoatTexture,    &Material::clearcoatRoughnessTexture, &Material::clearcoatNormalTexture,
    &Material::transmissionTexture, &Material::thicknessTexture};

template <typename T>
void append(std::vector<T>& all, const std::vector<T>& more) {
    all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

void appendSurfaces(Scene& scene, const Scene& from) {
    const auto vertices = uint32_t(scene.positions.size()), triangles = uint32_t(scene.triangles.size());
    const auto surfaces = uint32_t(scene.surfaces.size()), materials = uint32_t(scene.materials.size());
    const auto images = int32_t(scene.images.size());
    append(scene.positions, from.positions);
    append(scene.normals, from.normals);
    append(scene.tangents, from.tangents);
    append(scene.uv0, from.uv0);
    append(scene.uv1, from.uv1);
    append(scene.colors, from.colors);
    append(scene.images, from.images);
    for (const glm::uvec3& t : from.triangles) scene.triangles.push_back(t + vertices);
    for (const uint32_t surface : from.triangleSurface) scene.triangleSurface.push_back(surface + surfaces);
    for (Surface surface : from.surfaces) {
        surface.material += materials;
        surface.firstTriangle += triangles;
        surface.firstVertex += vertices;
        scene.surfaces.push_back(std::move(surface));
    }
    for (Material material : from.materials) {
        for (const auto texture : kTextures)
            if ((material.*texture).image >= 0) (material.*texture).image += images;
        scene.materials.push_back(std::move(material));
    }
}

}  // namespace phat
