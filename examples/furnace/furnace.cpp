// Bakes a closed box whose walls emit 1 W/(m2 sr) and reflect a half. The radiance in it is 1 / (1 - 1/2) = 2
// everywhere, of which 1 comes straight from the walls, and 1 after reflections.

#include <cstdio>

#include "core/bake/bake.h"

namespace {

phat::Material wallMaterial() {
    phat::Material material;
    material.baseColor = {0.5f, 0.5f, 0.5f, 1};
    material.metallic = 0;
    material.specular = 0;
    material.emission = glm::vec3(1);
    return material;
}

// Two triangles over corner, corner + along, corner + across; the front is where along x across points.
void addQuad(phat::Scene& scene, glm::vec3 corner, glm::vec3 along, glm::vec3 across) {
    phat::Surface surface;
    surface.firstTriangle = uint32_t(scene.triangles.size());
    surface.triangleCount = 2;
    surface.firstVertex = uint32_t(scene.positions.size());
    surface.vertexCount = 4;
    for (const glm::vec3 position : {corner, corner + along, corner + along + across, corner + across}) {
        scene.positions.push_back(position);
        scene.normals.push_back(glm::normalize(glm::cross(along, across)));
        scene.tangents.emplace_back(0);
        scene.uv0.emplace_back(0);
        scene.uv1.emplace_back(0);
        scene.colors.emplace_back(1);
    }
    const uint32_t first = surface.firstVertex;
    scene.triangles.insert(scene.triangles.end(),
                           {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
    scene.triangleSurface.insert(scene.triangleSurface.end(), 2, uint32_t(scene.surfaces.size()));
    scene.surfaces.push_back(surface);
}

phat::Scene box(float side) {
    phat::Scene scene;
    scene.materials.push_back(wallMaterial());
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 along(0), across(0), far(0);
        along[(axis + 1) % 3] = across[(axis + 2) % 3] = far[axis] = side;
        addQuad(scene, glm::vec3(0), along, across);
        addQuad(scene, far, across, along);
    }
    return scene;
}

// Over the PHATexels that hold a sample. In a furnace every sample is an estimate of the same radiance.
double meanRadiance(const phat::PhatexelLayer& layer, const std::vector<phat::Guide>& guides,
                    const phat::Atlas& atlas) {
    double sum = 0;
    uint64_t count = 0;
    for (uint32_t y = 0; y < atlas.sizeTexels.y; ++y)
        for (uint32_t x = 0; x < atlas.sizeTexels.x; ++x) {
            const phat::Phatexel phatexel = phat::phatexelAt(layer, guides, atlas, {x, y});
            if (!phatexel.valid) continue;
            sum += phatexel.radiance.g;
            ++count;
        }
    return sum / double(count);
}

}  // namespace

int main() {
    phat::BakeSettings settings;
    settings.atlas.texelBudget = 10'000;
    settings.photons.count = 50'000;
    phat::SilentProgress progress;
    const phat::Bake bake = phat::bake(box(2), settings, progress);

    const phat::Phatexture& baked = bake.phatexture;
    std::printf("from the walls %.3f, after reflections %.3f\n",
                meanRadiance(baked.area.at(0), baked.areaGuides, bake.atlas),
                meanRadiance(baked.indirect.at(0), baked.indirectGuides, bake.atlas));
}
