// The width of the display pass's cone, where charts differ in the size of their texels.

#include <gtest/gtest.h>

#include "core/scene/brdf.h"
#include "gl/phatexture_upload.h"
#include "gl/relight_pass.h"
#include "gl/renderer_world.h"
#include "gl/textures.h"

namespace phat::test {
namespace {

constexpr uint32_t kTiles = 6;

// Two metal floors of as many texels, one a quarter larger than the other, under light from `distance`.
RendererWorld twoFloors(float distance) {
    Scene scene;
    Material metal;
    metal.roughness = 0.3f;
    addFloor(scene, metal, 1);
    addFloor(scene, metal, 1.25f, -1);
    RendererWorld world = worldOfQuads(std::move(scene), kTiles);
    // Every texel expects as many samples under its lobe as every other.
    for (Guide& guide : world.phatexture.indirectGuides) guide = uniformGuide();
    for (uint32_t surface : {0u, 1u})
        fillPhatexels(
            world, surface, [](glm::vec3, glm::vec3) { return glm::vec3(1); }, distance);
    return world;
}

// Radii of the tiles, [tileY][tileX], seen from straight above.
std::vector<float> radiiOf(const RendererWorld& world) {
    const GpuAtlas atlas = uploadAtlas(world.scene, world.atlas, world.phatexture);
    const GpuTexelSurfaces surfaces = uploadTexelSurfaces(world.scene, world.atlas, world.points);
    const RelightPass pass = createRelightPass(kShaderFolder, atlas, false, false);
    GlTexture splitSum = createTexture2D(GL_RG32F, glm::uvec2(kSplitSumSize));
    glTextureSubImage2D(splitSum.name(), 0, 0, 0, kSplitSumSize, kSplitSumSize, GL_RG, GL_FLOAT,
                        splitSumTable().data());
    applyMaterials(pass, atlas, surfaces, world.scene.materials);
    relight(pass, atlas, surfaces, splitSum.name(), {{0, 1, 0}, true});
    buildPyramid(pass, atlas);
    std::vector<glm::vec4> values(world.atlas.tileChart.size());
    glGetTextureImage(pass.radii.name(), 0, GL_RGBA, GL_FLOAT, GLsizei(values.size() * sizeof(glm::vec4)),
                      values.data());
    checkGl("reading the radii");
    std::vector<float> radii;
    for (const glm::vec4& value : values) radii.push_back(value.r);
    return radii;
}

// Light from far away leaves the radius to the number of samples, the same in texels everywhere. Nearer light
// bounds it by a quarter of the distance, which is fewer of the larger texels.
TEST(RadiusOfTheCone, IsBoundedInEachChartsOwnTexels) {
    HeadlessContext context;
    const RendererWorld open = twoFloors(kFarDistance);
    const float size = open.atlas.charts[0].texelSizeMeters;
    ASSERT_NEAR(open.atlas.charts[1].texelSizeMeters, 1.25f * size, 1e-6f);
    const std::vector<float> wanted = radiiOf(open);
    for (const float radius : wanted) ASSERT_NEAR(radius, wanted[0], 1e-3f * wanted[0]);

    // Between the wanted radius and half of it, where the bound gives way (kMinSamples in radius.frag).
    const float distance = unpackDistance(packDistance(4 * 0.8f * wanted[0] * size, 1), 1);
    const RendererWorld near = twoFloors(distance);
    const std::vector<float> radii = radiiOf(near);
    for (size_t tile = 0; tile < radii.size(); ++tile) {
        const Chart& chart = near.atlas.charts[near.atlas.tileChart[tile]];
        const float expected = 0.25f * distance / chart.texelSizeMeters;
        ASSERT_LT(expected, 0.95f * wanted[0]);
        ASSERT_GT(expected, 0.55f * wanted[0]);
        ASSERT_NEAR(radii[tile], expected, 1e-3f * expected) << tile;
    }
}

}  // namespace
}  // namespace phat::test
