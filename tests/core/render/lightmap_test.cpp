#include "core/render/lightmap.h"

#include <gtest/gtest.h>

#include <map>

#include "core/base/random.h"
#include "core/render/punctual_irradiance.h"
#include "support/penumbra.h"

namespace phat {
namespace {

struct Baked {
    explicit Baked(Scene of, float texelSizeMeters) : scene(std::move(of)) {
        AtlasSettings settings;
        settings.texelSizeMeters = texelSizeMeters;
        atlas = buildAtlas(scene, {}, settings, progress);
        points = buildTexelPoints(scene, atlas);
        phatexture.indirectIrradiance.assign(atlas.texelCount(), packRgb9e5(glm::vec3(1)));
        phatexture.areaIrradiance.assign(atlas.texelCount(), packRgb9e5(glm::vec3(2)));
    }

    std::vector<glm::vec3> lightmap(LightmapLight light) {
        return lightmapOf({scene, atlas, points, phatexture}, light, false, progress).irradiance;
    }

    SilentProgress progress;
    Scene scene;
    Atlas atlas;
    TexelPoints points;
    Phatexture phatexture;
    RayScene rays{scene};
    LightSampler lights{scene};
};

TEST(Lightmap, LightsAddUp) {
    Scene floor;
    test::addFloor(floor, test::lambert(1), 2);
    floor.lights.push_back(test::directionalLight(glm::vec3(4), {0, -1, 0}));
    Baked baked(floor, 0.1f);
    const auto indirect = baked.lightmap(LightmapLight::indirect), area = baked.lightmap(LightmapLight::area),
               all = baked.lightmap(LightmapLight::all);
    for (size_t i = 0; i < indirect.size(); ++i) {
        ASSERT_EQ(indirect[i], glm::vec3(1));
        ASSERT_EQ(area[i], glm::vec3(3));
        ASSERT_NEAR(all[i].x, 7, 1e-5f);  // gutters, too
    }
}

// source: Lambert's law. The mean over a texel of a twentieth of the distance differs from its middle's value
// by less than the square of that.
TEST(Lightmap, APointLightFallsOffByTheSquare) {
    Scene floor;
    test::addFloor(floor, test::lambert(1), 4);
    floor.lights.push_back(test::pointLight({3, 2, 1}, {0.3f, 2, -0.4f}));
    Baked baked(floor, 0.1f);
    const auto light =
        punctualIrradiance({baked.rays, baked.lights}, baked.atlas, baked.points, baked.progress);
    size_t compared = 0;
    for (size_t i = 0; i < light.size(); ++i) {
        if (baked.points.state[i] != TexelState::surface) continue;
        const glm::vec3 way = floor.lights[0].position - baked.points.position[i];
        const float expected = 2 / (glm::dot(way, way) * glm::length(way));
        ASSERT_NEAR(light[i].r, 3 * expected, 0.0075f * expected);
        ASSERT_NEAR(light[i].b, expected, 0.0025f * expected);
        ++compared;
    }
    EXPECT_GT(compared, 1500u);
}

// The shadow's border lies within texels, whose light is the part of them that is lit, to a column of points.
TEST(Lightmap, AShadowIsFilteredByTheTexel) {
    Baked baked(test::floorBehindEdge(0), 0.13f);
    const auto light =
        punctualIrradiance({baked.rays, baked.lights}, baked.atlas, baked.points, baked.progress);
    size_t partly = 0;
    for (size_t i = 0; i < light.size(); ++i) {
        const glm::vec3 p = baked.points.position[i];
        if (baked.points.state[i] != TexelState::surface || p.y > 1) continue;
        const float lit = std::clamp(0.5f + p.x / baked.atlas.texelMetersAt(i), 0.0f, 1.0f);
        ASSERT_NEAR(light[i].x, lit, 0.51f / kPunctualPointsPerSide);
        partly += light[i].x > 0.01f && light[i].x < 0.99f;
    }
    EXPECT_GT(partly, 20u);
}

// A sun is a disc: its shadow's border is as wide as that of rays to all of it. The mean over the rows of the
// floor has the noise of some hundred points on the disc, 1/sqrt(12 * 100) at most.
TEST(Lightmap, ASunHasAPenumbra) {
    constexpr float kAngularRadius = 0.05f;
    Baked baked(test::floorBehindEdge(kAngularRadius), 0.05f);
    const auto light =
        punctualIrradiance({baked.rays, baked.lights}, baked.atlas, baked.points, baked.progress);
    constexpr float kWithinEdge = 2 - test::kEdgeHeight * kAngularRadius;  // the edge has ends, too
    std::map<int, std::pair<double, int>> columns;                         // by x in cm
    for (size_t i = 0; i < light.size(); ++i) {
        const glm::vec3 p = baked.points.position[i];
        if (baked.points.state[i] != TexelState::surface || p.y > 1 || std::abs(p.z) > kWithinEdge) continue;
        auto& [sum, count] = columns[int(std::lround(100 * p.x))];
        sum += light[i].x;
        ++count;
    }
    size_t within = 0;
    for (const auto& [x, column] : columns) {
        const double offset = x / 100.0 / (test::kEdgeHeight * kAngularRadius);
        EXPECT_NEAR(column.first / column.second, test::discFraction(offset), 0.03) << x;
        within += std::abs(offset) < 1;
    }
    EXPECT_GT(within, 10u);
}

// A layer whose PHATexels say that all light comes from above, at a slant.
PhatexelLayer layerFrom(const Baked& baked, const std::vector<Frame>& frames, glm::vec3 towardLight) {
    PhatexelLayer layer;
    layer.texels.resize(baked.atlas.texelCount());
    for (size_t i = 0; i < layer.texels.size(); ++i) {
        if (!baked.points.valid(i)) continue;
        const glm::uvec2 texel(i % baked.atlas.sizeTexels.x, i / baked.atlas.sizeTexels.x);
        const Frame& frame = frames[baked.atlas.blockAt(texel)];
        layer.texels[i] = packPhatexel({glm::vec3(3), frame.toLocal(towardLight), 5, 1, true}, 1);
    }
    return layer;
}

TEST(Lightmap, TermsPointToWhereTheLightIs) {
    Scene floor;
    test::addFloor(floor, test::lambert(1), 2);
    floor.lights.push_back(test::directionalLight(glm::vec3(5), {0, -0.8f, 0.6f}));
    Baked baked(floor, 0.1f);
    const auto frames = blockFrames(baked.atlas, baked.points);
    const glm::vec3 indirect(0.6f, 0.8f, 0), sun(0, 0.8f, -0.6f);
    baked.phatexture.indirect = {layerFrom(baked, frames, indirect)};
    baked.phatexture.indirectGuides = {uniformGuide()};
    baked.phatexture.areaIrradiance.clear();
    const LightmapInput input{baked.scene, baked.atlas, baked.points, baked.phatexture};
    const Lightmap lightmap = lightmapOf(input, LightmapLight::all, true, baked.progress);
    const std::array<glm::vec3, 3> normals = {glm::vec3(0, 1, 0), indirect, sun};
    for (size_t i = 0; i < lightmap.irradiance.size(); ++i) {
        if (baked.points.state[i] != TexelState::surface) continue;
        ASSERT_NEAR(lightmap.irradiance[i].x, 1 + 4, 1e-4f);
        for (const glm::vec3& n : normals) {
            // To order 1 light w of flux density f has f (1 + 2 n.w) / 4; scaled to what the floor receives.
            const auto model = [&](glm::vec3 w) { return (1 + 2 * glm::dot(n, w)) / (1 + 2 * w.y); };
            const float expected = model(indirect) + 4 * model(sun);
            // Directions have 12 bits an axis.
            ASSERT_NEAR(lightmap.byNormal->at(i, n).x, expected, 0.002f * expected);
        }
    }
}

// What comes from all of the hemisphere alike has irradiance pi L on the floor, half of it on a wall.
TEST(Lightmap, TermsOfAnEvenSkyAreThoseOfItsIrradiance) {
    Scene floor;
    test::addFloor(floor, test::lambert(1), 4);
    Baked baked(floor, 0.05f);
    const auto frames = blockFrames(baked.atlas, baked.points);
    PhatexelLayer layer = layerFrom(baked, frames, {0, 1, 0});
    Rng rng(7);
    for (size_t i = 0; i < layer.texels.size(); ++i)
        if (baked.points.valid(i))
            layer.texels[i] =
                packPhatexel({glm::vec3(2), squareToHemisphere(rng.uniform2()), 5, 1 / (2 * kPi), true}, 1);
    baked.phatexture.indirect = {layer};
    baked.phatexture.indirectGuides = {uniformGuide()};
    const LightmapInput input{baked.scene, baked.atlas, baked.points, baked.phatexture};
    const Lightmap lightmap = lightmapOf(input, LightmapLight::indirect, true, baked.progress);
    double up = 0, aside = 0, count = 0;
    for (size_t i = 0; i < lightmap.irradiance.size(); ++i) {
        if (baked.points.state[i] != TexelState::surface) continue;
        ASSERT_NEAR(lightmap.byNormal->at(i, {0, 1, 0}).x, 1, 1e-4f);
        up += lightmap.byNormal->at(i, {0, 1, 0}).x;
        aside += lightmap.byNormal->at(i, {1, 0, 0}).x;
        ++count;
    }
    // 6,400 directions: the mean cosine toward x has a standard error of sqrt(1/3/6400) = .007 of the flux.
    EXPECT_NEAR(aside / up, 0.5, 3 * 0.007);
    EXPECT_GT(count, 6000);
}

}  // namespace
}  // namespace phat
