// Borders between charts in the picture of a baked sphere.

#include <gtest/gtest.h>

#include "core/bake/bake.h"
#include "core/bake/seam_stitch.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

void addSphere(Scene& scene, glm::vec3 center, float radius) {
    constexpr int kSegments = 32, kRings = 16;
    addSurface(scene, lambert(0.5f));
    Surface& surface = scene.surfaces.back();
    for (int y = 0; y <= kRings; ++y)
        for (int x = 0; x <= kSegments; ++x) {
            const float phi = 2 * kPi * float(x % kSegments) / kSegments, theta = kPi * float(y) / kRings;
            const float s = y == 0 || y == kRings ? 0.0f : std::sin(theta);
            const glm::vec3 normal(s * std::cos(phi), s * std::sin(phi), -std::cos(theta));
            scene.positions.push_back(center + radius * normal);
            scene.normals.push_back(normal);
            scene.tangents.push_back(glm::vec4(0));
            scene.uv0.push_back(glm::vec2(0));
            scene.uv1.push_back(glm::vec2(0));
            scene.colors.push_back(glm::vec4(1));
        }
    for (int y = 0; y < kRings; ++y)
        for (int x = 0; x < kSegments; ++x) {
            const uint32_t i = surface.firstVertex + uint32_t(y * (kSegments + 1) + x),
                           up = i + kSegments + 1;
            for (const glm::uvec3 t : {glm::uvec3(i, i + 1, up + 1), glm::uvec3(i, up + 1, up)}) {
                scene.triangles.push_back(t);
                scene.triangleSurface.push_back(uint32_t(scene.surfaces.size() - 1));
            }
        }
    surface.triangleCount = 2 * kSegments * kRings;
    surface.vertexCount = (kSegments + 1) * (kRings + 1);
}

/// The jumps that a picture shows along the cuts, over the light there (in the dark, over a fifth of the
/// mean).
double jumpOfRank(const Bake& bake, const std::vector<SeamPoint>& seams, const std::vector<uint32_t>& packed,
                  double rank) {
    IrradianceMap map;
    double mean = 0;
    for (const uint32_t value : packed) {
        map.push_back(unpackRgb9e5(value));
        mean += luminance(map.back()) / double(packed.size());
    }
    std::vector<double> jumps;
    for (const SeamPoint& seam : seams) {
        const double a = luminance(irradianceAt(map, bake.atlas, seam.chart[0], seam.position[0]));
        const double b = luminance(irradianceAt(map, bake.atlas, seam.chart[1], seam.position[1]));
        jumps.push_back(std::abs(a - b) / std::max(0.5 * (a + b), 0.2 * mean));
    }
    std::sort(jumps.begin(), jumps.end());
    return jumps[size_t(rank * double(jumps.size() - 1))];
}

// A texel spans 4 degrees of the sphere: without stitching, one border point in a hundred jumps by .43 in the
// lamp's light and by .09 in the rest. more.
TEST(Seams, BordersOnASphereDoNotShow) {
    Scene scene;
    addRoom(scene, lambert(0.6f), {1, 1, 1});
    scene.materials[0].baseColor = {0.8f, 0.2f, 0.2f, 1};
    addQuad(scene, emitter(glm::vec3(4), 0.5f), {0.3f, 0.95f, 0.3f}, {0.4f, 0, 0}, {0, 0, 0.4f});
    addSphere(scene, {0.5f, 0.4f, 0.5f}, 0.25f);
    BakeSettings settings;
    settings.atlas.texelBudget = 60'000;
    settings.photons.count = 20'000;
    settings.pathsPerPhatexel = 1;
    SilentProgress progress;
    const Bake result = bake(scene, settings, progress);
    const std::vector<SeamPoint> seams = findSeams(scene, result.atlas);
    ASSERT_GT(seams.size(), 300u);
    EXPECT_LT(jumpOfRank(result, seams, result.phatexture.areaIrradiance, 0.99), 0.03);
    EXPECT_LT(jumpOfRank(result, seams, result.phatexture.indirectIrradiance, 0.99), 0.03);
    EXPECT_LT(jumpOfRank(result, seams, result.phatexture.areaIrradiance, 0.5), 0.003);
    EXPECT_LT(jumpOfRank(result, seams, result.phatexture.indirectIrradiance, 0.5), 0.003);
}

}  // namespace
}  // namespace phat
