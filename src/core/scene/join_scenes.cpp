#include "core/scene/join_scenes.h"

#include "core/scene/append_vertices.h"

namespace phat {
namespace {

constexpr TextureSlot Material::*kTextures[] = {
    &Material::baseColorTexture,    &Material::metallicRoughnessTexture,  &Material::normalTexture,
    &Material::emissionTexture,     &Material::specularTexture,           &Material::specularColorTexture,
    &Material::clearcoatTexture,    &Material::clearcoatRoughnessTexture, &Material::clearcoatNormalTexture,
    &Material::transmissionTexture, &Material::thicknessTexture};

}  // namespace

void appendSurfaces(Scene& scene, const Scene& from) {
    const auto vertices = uint32_t(scene.positions.size()), triangles = uint32_t(scene.triangles.size());
    const auto surfaces = uint32_t(scene.surfaces.size()), materials = uint32_t(scene.materials.size());
    const auto images = int32_t(scene.images.size());
    appendVertices(scene, from);
    scene.images.insert(scene.images.end(), from.images.begin(), from.images.end());
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
