#include "scene_promises.h"

#include <cmath>

#include "expect.h"

namespace phat::fuzz {
namespace {

bool isFinite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void expectVertices(const Scene& scene) {
    const size_t count = scene.positions.size();
    for (const size_t size : {scene.normals.size(), scene.tangents.size(), scene.uv0.size(), scene.uv1.size(),
                              scene.colors.size()})
        expect(size == count, "an element for every vertex");
    for (size_t i = 0; i < count; ++i) {
        expect(isFinite(scene.positions[i]), "finite positions");
        expect(isFinite(scene.normals[i]), "finite normals");
        expect(isFinite(glm::vec3(scene.tangents[i])), "finite tangents");
        expect(isFinite(glm::vec3(scene.colors[i])), "finite colours");
        expect(std::isfinite(scene.uv0[i].x + scene.uv0[i].y), "finite texture coordinates");
        expect(std::isfinite(scene.uv1[i].x + scene.uv1[i].y), "finite texture coordinates");
    }
}

void expectTriangles(const Scene& scene) {
    expect(scene.triangleSurface.size() == scene.triangles.size(), "a surface for every triangle");
    for (const glm::uvec3& triangle : scene.triangles)
        for (int corner = 0; corner < 3; ++corner)
            expect(triangle[corner] < scene.positions.size(), "corners that are vertices");
    for (const uint32_t surface : scene.triangleSurface)
        expect(surface < scene.surfaces.size(), "surfaces that exist");
    for (const Surface& surface : scene.surfaces) {
        expect(surface.material < scene.materials.size(), "materials that exist");
        expect(uint64_t(surface.firstTriangle) + surface.triangleCount <= scene.triangles.size(),
               "triangles of a surface");
        expect(uint64_t(surface.firstVertex) + surface.vertexCount <= scene.positions.size(),
               "vertices of a surface");
        expect(surface.node < scene.nodes.size(), "nodes that exist");
    }
}

void expectSlots(const Scene& scene) {
    for (const Material& m : scene.materials)
        for (const TextureSlot* slot :
             {&m.baseColorTexture, &m.metallicRoughnessTexture, &m.normalTexture, &m.emissionTexture,
              &m.specularTexture, &m.specularColorTexture, &m.clearcoatTexture, &m.clearcoatRoughnessTexture,
              &m.clearcoatNormalTexture, &m.transmissionTexture, &m.thicknessTexture})
            expect(slot->image < int32_t(scene.images.size()) && slot->uvSet >= 0 && slot->uvSet <= 1,
                   "textures that exist");
    for (const auto& image : scene.images)
        expect(image->texels.size() == size_t(image->width) * size_t(image->height), "texels of an image");
}

void expectMotion(const Scene& scene) {
    for (const Animation& animation : scene.animations) {
        for (const AnimationChannel& channel : animation.channels)
            expect(channel.node < scene.nodes.size(), "channels of nodes that exist");
        expect(worldFromRest(scene.nodes, animation, 0.5 * double(animation.seconds())).size() ==
                   scene.nodes.size(),
               "a pose of every node");
    }
}

}  // namespace

void expectConsistent(const Scene& scene) {
    expectVertices(scene);
    expectTriangles(scene);
    expectSlots(scene);
    for (const PunctualLight& light : scene.lights) {
        expect(isFinite(light.intensity) && isFinite(light.position) && isFinite(light.direction),
               "finite lights");
        expect(light.node < scene.nodes.size(), "nodes of lights");
    }
    for (size_t i = 0; i < scene.nodes.size(); ++i)
        expect(scene.nodes[i].parent < int32_t(scene.nodes.size()) && scene.nodes[i].parent != int32_t(i),
               "parents that exist");
    expectMotion(scene);
}

}  // namespace phat::fuzz
