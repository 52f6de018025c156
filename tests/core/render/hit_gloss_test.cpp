// Glossy light on what reflection rays hit.

#include "core/render/hit_gloss.h"

#include <gtest/gtest.h>

namespace phat::test {
namespace {

SurfacePoint glossyFloor(float alpha, float x) {
    SurfacePoint point;
    point.position = {x, 0, 0};
    point.shading = frameFromNormal({0, 1, 0});
    point.brdf.alpha = alpha;
    return point;
}

HitReflection reflected(glm::vec3 light, glm::vec3 albedo, float nearness) {
    HitReflection reflection;
    reflection.glossy = light * albedo;
    reflection.glossyAlbedo = albedo;
    reflection.walks = 4;
    reflection.nearness = nearness;
    return reflection;
}

const glm::vec3 kDown(0, -1, 0);

TEST(HitGloss, CarriesWhatItsRaysFound) {
    HitGlossSum sum;
    const SurfacePoint a = glossyFloor(0.1f, 1), b = glossyFloor(0.3f, 3);
    // Red is not reflected by either: no division by zero.
    const HitReflection atA = reflected({5, 2, 1}, {0, 0.5f, 1}, 1),
                        atB = reflected({5, 4, 2}, {0, 0.25f, 1}, 3);
    EXPECT_TRUE(sum.add({7, kDown, a, atA}, glm::vec3(1)));
    EXPECT_TRUE(sum.add({7, kDown, b, atB}, glm::vec3(1)));
    const HitGloss gloss = sum.mean(4);  // two more rays found nothing
    const glm::vec3 light = gloss.carried * gloss.light.indirect;
    EXPECT_FLOAT_EQ(light.x, 0);
    EXPECT_FLOAT_EQ(light.y, (2 * 0.5f + 4 * 0.25f) / 4);
    EXPECT_FLOAT_EQ(light.z, (1 + 2) / 4.0f);
    EXPECT_FLOAT_EQ(gloss.light.weight, 8);
    EXPECT_EQ(gloss.lobe.side, 7u);
    EXPECT_EQ(gloss.lobe.position, glm::vec3(2, 0, 0));
    EXPECT_EQ(gloss.lobe.mirror, glm::vec3(0, 1, 0));
    EXPECT_FLOAT_EQ(gloss.lobe.alpha, 0.2f);
    EXPECT_FLOAT_EQ(gloss.lobe.distance, 0.5f);
}

TEST(HitGloss, OtherSurfacesAndDiffuseOnesAreLeftToTheCaller) {
    HitGlossSum sum;
    const SurfacePoint point = glossyFloor(0.1f, 0);
    const HitReflection glossy = reflected(glm::vec3(1), glm::vec3(1), 1);
    EXPECT_FALSE(sum.add({1, kDown, point, HitReflection{}}, glm::vec3(1)));
    EXPECT_EQ(sum.mean(1).lobe.alpha, 0);
    EXPECT_TRUE(sum.add({1, kDown, point, glossy}, glm::vec3(1)));
    EXPECT_FALSE(sum.add({2, kDown, point, glossy}, glm::vec3(1)));
    EXPECT_FLOAT_EQ(sum.mean(1).light.indirect.x, 1);
}

TEST(HitGloss, ACoatDecidesWhatIsAlike) {
    HitGlossSum sum;
    SurfacePoint point = glossyFloor(0.5f, 0);
    point.brdf.clearcoat = 1;
    point.brdf.clearcoatAlpha = 0.02f;
    const HitReflection glossy = reflected(glm::vec3(1), glm::vec3(1), 1);
    sum.add({1, kDown, point, glossy}, glm::vec3(1));
    EXPECT_FLOAT_EQ(sum.mean(1).lobe.alpha, 0.02f);
}

}  // namespace
}  // namespace phat::test
