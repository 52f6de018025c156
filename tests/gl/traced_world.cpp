#include "gl/traced_world.h"

#include <gtest/gtest.h>

namespace phat::test {

Material whiteMetal(float roughness) {
    Material material;
    material.roughness = roughness;
    return material;
}

Scene floorAndCeiling(const Material& floor, const Material& ceiling, float size) {
    Scene scene;
    addFloor(scene, floor, size);
    addCeiling(scene, ceiling, size, 2);
    return scene;
}

Environment skyOfHalves(float ahead, float elsewhere) {
    Environment environment{Image(64, 32)};
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x)
            environment.radiance.at(x, y) = glm::vec3(x < 32 && y < 16 ? ahead : elsewhere);
    return environment;
}

Scene mirrorUnderTwoPanels() {
    Scene scene;
    addFloor(scene, whiteMetal(0), 8);
    addQuad(scene, emitter(glm::vec3(1)), {-4, 2, -4}, {4, 0, 0}, {0, 0, 8});
    addQuad(scene, emitter(glm::vec3(9)), {0, 2, -4}, {4, 0, 0}, {0, 0, 8});
    return scene;
}

void expectMirroredBorder(const Image& image, const Camera& camera) {
    const glm::vec3 eye(camera.worldFromCamera[3]);
    int dark = 0, bright = 0, wrong = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const glm::vec3 d = pixelDirection(camera, x, y, image.width, image.height);
            if (d.y > -0.1f) continue;
            const glm::vec3 floor = eye - eye.y / d.y * d;
            const glm::vec3 seen = floor + 2 / -d.y * glm::vec3(d.x, -d.y, d.z);
            if (glm::any(glm::greaterThan(glm::abs(glm::vec2(floor.x, floor.z)), glm::vec2(3.9f))) ||
                glm::any(glm::greaterThan(glm::abs(glm::vec2(seen.x, seen.z)), glm::vec2(3.9f))) ||
                std::abs(seen.x) < 0.05f)
                continue;
            wrong += std::abs(image.at(x, y).x - (seen.x < 0 ? 1 : 9)) > 0.1f;
            ++(seen.x < 0 ? dark : bright);
        }
    }
    EXPECT_GT(dark, 200);
    EXPECT_GT(bright, 200);
    // GGX has long tails: of a mirror's rays (alpha .001) one in a thousand leaves by more than 3 degrees.
    EXPECT_LT(wrong, 0.01 * (dark + bright));
}

void setIrradiance(RendererWorld& world, uint32_t surface, float wattsPerSquareMeter) {
    for (uint32_t y = 0; y < world.atlas.sizeTexels.y; ++y)
        for (uint32_t x = 0; x < world.atlas.sizeTexels.x; ++x)
            if (world.atlas.chartAt({x, y}) == surface)
                world.phatexture.indirectIrradiance[size_t(y) * world.atlas.sizeTexels.x + x] =
                    packRgb9e5(glm::vec3(wattsPerSquareMeter));
}

void fillWithLookups(RendererWorld& world, float indirect, float area) {
    const auto layerOf = [&](float radiance) {
        const LightAt everywhere = [&](glm::vec3, glm::vec3) { return glm::vec3(radiance); };
        return layerInBakedOrder(world, everywhere, 2);
    };
    world.phatexture.indirect = {layerOf(indirect)};
    world.phatexture.area = {layerOf(area)};
    world.phatexture.areaGuides = world.phatexture.indirectGuides;
    world.phatexture.areaIrradiance.assign(world.atlas.texelCount(), packRgb9e5(glm::vec3(kPi * area)));
    prepareLookup(world);
}

}  // namespace phat::test
