// The peers where the answer is known: rooms in which the reflected radiance is 1 everywhere.

#include <gtest/gtest.h>

#include "core/base/hemisphere_map.h"
#include "gaussian_lightmap.h"
#include "peer_picture.h"
#include "reflection_probe.h"
#include "support/scene_builder.h"

namespace phat::peers {
namespace {

using namespace test;

// Albedo .5 and 1 nit: 1 + 1/2 + 1/4 ...; what was reflected is 1 but for the bounces after the 30th.
struct Furnace {
    Furnace() : scene(made()), rays(scene), lights(scene) {}
    static Scene made() {
        Scene scene;
        addRoom(scene, emitter(glm::vec3(1), 0.5f), glm::vec3(2));
        return scene;
    }
    Furnace(const Furnace&) = delete;
    Furnace& operator=(const Furnace&) = delete;

    const Scene scene;
    const RayScene rays;
    const LightSampler lights;
    SilentProgress progress;
};

constexpr int kBounces = 30;

struct Spread {
    double sum = 0, squares = 0, count = 0;
    void add(double x) { sum += x, squares += x * x, ++count; }
    double mean() const { return sum / count; }
    double errorOfMean() const { return std::sqrt((squares / count - mean() * mean()) / count); }
};

SurfacePoint metalFloor(float alpha) {
    SurfacePoint point;
    point.position = {1, 0, 1};
    point.shading = frameFromNormal({0, 1, 0});
    point.brdf.diffuseColor = glm::vec3(0);
    point.brdf.f0 = glm::vec3(0.8f);
    point.brdf.alpha = alpha;
    return point;
}

ProbeSettings probeSettings(const Scene& scene) {
    ProbeSettings settings;
    settings.box = boundsOf(scene);
    settings.position = {0.7f, 0.9f, 1.2f};
    settings.faceSize = 8;
    settings.paths = {16, kBounces};
    return settings;
}

TEST(ReflectionProbe, FurnaceArrivesWhole) {
    Furnace furnace;
    const ReflectionProbe probe =
        bakeProbe(furnace.rays, furnace.lights, probeSettings(furnace.scene), furnace.progress);
    Spread spread;
    for (const glm::vec3& texel : probe.radiance) spread.add(texel.x);
    // Four standard errors, and RGB9E5 in the least favourable direction.
    EXPECT_NEAR(spread.mean(), 1.0, 4 * spread.errorOfMean() + 0x1p-9);
    EXPECT_LT(spread.errorOfMean(), 0.03);
}

TEST(ReflectionProbe, UniformLightReflectsTheAlbedo) {
    ReflectionProbe probe{{1, 1, 1}, {glm::vec3(0), glm::vec3(2)}, 4, {}};
    probe.radiance.assign(6 * 4 * 4, glm::vec3(1));
    for (const float alpha : {0.02f, 0.2f, 0.6f}) {
        for (const float nDotV : {0.2f, 0.6f, 1.0f}) {
            const SurfacePoint point = metalFloor(alpha);
            const glm::vec3 eye(std::sqrt(1 - nDotV * nDotV), nDotV, 0);
            EXPECT_NEAR(shadeByProbe(probe, point, eye).x, specularAlbedo(point.brdf.f0, 1, alpha, nDotV).x,
                        1e-4f);
        }
    }
}

// What stands on the box's wall is found from anywhere in the box.
TEST(ReflectionProbe, BoxProjectionHitsTheSamePoint) {
    const ReflectionProbe probe{{0.7f, 0.9f, 1.2f}, {glm::vec3(0), glm::vec3(2)}, 1, {}};
    const glm::vec3 onWall(2, 1.3f, 0.4f), from(0.3f, 0, 1.7f);
    const glm::vec3 found = boxProjected(probe, from, glm::normalize(onWall - from));
    EXPECT_LT(glm::distance(found, glm::normalize(onWall - probe.position)), 1e-5f);
}

TEST(ReflectionProbe, DirectionsFindTheirTexel) {
    ReflectionProbe probe{glm::vec3(0), {glm::vec3(-1), glm::vec3(1)}, 1, {}};
    for (int face = 0; face < 6; ++face) probe.radiance.emplace_back(float(face));
    for (int face = 0; face < 6; ++face) {
        glm::vec3 direction(0.3f);
        direction[face / 2] = face % 2 == 0 ? 0.9f : -0.9f;
        EXPECT_EQ(probeRadiance(probe, glm::normalize(direction)).x, float(face));
    }
}

TEST(ReflectionProbe, FillsItsBytes) {
    for (const uint64_t bytes : {1'000ull, 123'456ull, 9'999'999ull}) {
        EXPECT_LE(probeBytes(probeFaceSize(bytes)), bytes);
        EXPECT_GT(probeBytes(probeFaceSize(bytes) + 1), bytes);
    }
}

TEST(GaussianLightmap, FurnaceKeepsEveryMoment) {
    Furnace furnace;
    GaussianSettings settings;
    settings.texelSizeMeters = 0.2f;
    settings.paths = {1, kBounces};
    const uint32_t floor = furnace.scene.surfaces[2].material;
    const GaussianLightmap lightmap =
        bakeGaussians(furnace.rays, furnace.lights, floor, settings, furnace.progress);
    ASSERT_GT(lightmap.texelCount, 50u);
    for (size_t i = 0; i < kGaussians; ++i) {
        // Integral over the hemisphere of the gaussian alone: what it should see of radiance 1.
        constexpr int kSide = 128;
        double expected = 0;
        for (int cell = 0; cell < kSide * kSide; ++cell) {
            const glm::vec2 square = (glm::vec2(cell % kSide, cell / kSide) + 0.5f) / float(kSide);
            expected += std::exp(lightmap.basis.sharpness *
                                 (glm::dot(lightmap.basis.axis[i], squareToHemisphere(square)) - 1)) *
                        2 * kPi / (kSide * kSide);
        }
        Spread spread;
        for (size_t texel = 0; texel < lightmap.texels.size(); ++texel) {
            if (lightmap.points.state[texel] != TexelState::surface ||
                materialAt(furnace.scene, lightmap.points.triangle[texel]) != floor)
                continue;
            double moment = 0;
            for (size_t j = 0; j < kGaussians; ++j)
                moment += lightmap.basis.products[i][j] * lightmap.texels[texel][j].x;
            spread.add(moment / expected);
        }
        EXPECT_NEAR(spread.mean(), 1.0, 4 * spread.errorOfMean() + 0x1p-9) << i;
        EXPECT_LT(spread.errorOfMean(), 0.03) << i;
    }
}

TEST(GaussianLightmap, FitFindsItsOwnAmplitudes) {
    const GaussianBasis basis = hemisphereGaussians();
    Amplitudes given{}, moments{};
    for (size_t i = 0; i < kGaussians; ++i) given[i] = glm::vec3(float(i % 3), 1, 0.1f * float(i));
    for (size_t i = 0; i < kGaussians; ++i)
        for (size_t j = 0; j < kGaussians; ++j) moments[i] += basis.products[i][j] * given[j];
    const Amplitudes found = fitGaussians(basis, moments);
    for (size_t i = 0; i < kGaussians; ++i) EXPECT_LT(glm::distance(found[i], given[i]), 1e-3f) << i;
}

// A narrow lobe reads one direction, whichever way.
TEST(GaussianLightmap, NarrowLobesSeeTheMirroredDirection) {
    Scene scene;
    addFloor(scene, lambert(0.5f), 2);
    const RayScene rays(scene);
    SilentProgress progress;
    GaussianLightmap lightmap;
    lightmap.basis = hemisphereGaussians();
    AtlasSettings settings;
    settings.texelSizeMeters = 0.1f;
    lightmap.atlas = buildAtlas(scene, {}, settings, progress);
    lightmap.points = buildTexelPoints(scene, lightmap.atlas);
    Amplitudes amplitudes{};
    for (size_t i = 0; i < kGaussians; ++i) amplitudes[i] = glm::vec3(float(1 + i));
    lightmap.texels.assign(lightmap.atlas.texelCount(), amplitudes);

    const Hit hit = rays.closestHit({0.1f, 1, 0.1f}, {0, -1, 0});
    ASSERT_TRUE(hit);
    const SurfacePoint point = metalFloor(0.01f);
    const glm::vec3 eye = glm::normalize(glm::vec3(0.2f, 0.9f, 0.1f)), mirrored(-eye.x, eye.y, -eye.z);
    size_t lit = 0;
    while (!lightmap.points.valid(lit)) ++lit;
    const Frame texel = frameFromNormalAndTangent(lightmap.points.normal[lit], lightmap.points.tangent[lit]);
    const float expected = gaussianRadiance(lightmap.basis, amplitudes, texel.toLocal(mirrored)).x *
                           specularAlbedo(point.brdf.f0, 1, point.brdf.alpha, eye.y).x;
    for (const GaussianReading reading : {GaussianReading::warped, GaussianReading::exact})
        // The lobe's own width, of order alpha * sharpness, and the albedo table's 2e-3.
        EXPECT_NEAR(shadeByGaussians(lightmap, hit, point, eye, reading).x / expected, 1,
                    0.01f * lightmap.basis.sharpness * 0.2f + 2e-3f);
}

TEST(PeerPicture, MaskKeepsPixelsWithoutEdges) {
    Scene scene;
    addFloor(scene, lambert(0.5f), 2);
    scene.materials[0].name = "floor";
    const RayScene rays(scene);
    Camera camera;
    camera.worldFromCamera = glm::mat4(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 2, 0, 1);  // looks down
    camera.yfovRadians = 2 * std::atan(1.0f);                                             // sees 4 m from 2 m
    const Image mask = materialMask(rays, materialNamed(scene, "floor"), camera, 31, 31);
    int kept = 0;
    for (const glm::vec3& pixel : mask.pixels) kept += pixel.x > 0.5f;
    // The floor covers 15.5 pixels a side, centred: 15 of them wholly.
    EXPECT_EQ(kept, 15 * 15);
    EXPECT_THROW(materialNamed(scene, "ceiling"), std::invalid_argument);
}

TEST(PeerPicture, ThinnedMasksAreScatteredPartsOfTheMask) {
    Image mask(40, 20);
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 20; ++x) mask.at(x, y) = glm::vec3(1);
    const Image thin = thinned(mask, 100);
    int kept = 0, quarters[4] = {};
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 40; ++x) {
            if (thin.at(x, y).x < 0.5f) continue;
            EXPECT_LT(x, 20);
            ++kept;
            ++quarters[x / 10 + 2 * (y / 10)];
        }
    }
    EXPECT_EQ(kept, 100);
    // 25 expected, sigma 3.8.
    for (const int quarter : quarters) EXPECT_NEAR(quarter, 25, 4 * 3.8);
    EXPECT_EQ(thinned(mask, 1000).pixels, mask.pixels);

    keepWindow(mask, 15, 18, 10, 10);
    kept = 0;
    for (const glm::vec3& pixel : mask.pixels) kept += pixel.x > 0.5f;
    EXPECT_EQ(kept, 5 * 2);
}

}  // namespace
}  // namespace phat::peers
