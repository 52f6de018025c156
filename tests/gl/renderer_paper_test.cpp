// The paper's estimator to the letter: right where directions are uniform, and off by a known factor
// elsewhere.

#include <gtest/gtest.h>

#include "core/scene/brdf.h"
#include "gl/renderer_world.h"

namespace phat::test {
namespace {

class RendererPaper : public ::testing::Test {
  protected:
    HeadlessContext context_;
};

constexpr uint32_t kTiles = 16;  // 16,384 PHATexels
const Camera kAbove = lookAtCamera({0, 3, 0.6f}, {0, 0, 0}, 22);

Material coatedPlastic() {
    Material material;
    material.baseColor = {0.5f, 0.4f, 0.3f, 1};
    material.metallic = 0;
    material.roughness = 0.7f;
    material.clearcoat = 1;
    material.clearcoatRoughness = 0.6f;
    return material;
}

RendererWorld floorWith(const Material& material, const Guide& guide, const LightAt& light) {
    Scene scene;
    addFloor(scene, material, 2);
    RendererWorld world = worldOfQuads(scene, kTiles);
    for (Guide& of : world.phatexture.indirectGuides) of = guide;
    fillPhatexels(world, 0, light);
    return world;
}

FrameSettings frame(Method method, Component component) {
    FrameSettings settings;
    settings.width = 48;
    settings.height = 32;
    settings.camera = kAbove;
    settings.method = method;
    settings.component = component;
    settings.samplesPerPixel = 1;
    return settings;
}

/// Mean over the picture, and of what `expected` says of each pixel's local direction toward the eye.
struct Means {
    glm::dvec3 got{0}, want{0};
    double ratio(int channel) const { return got[channel] / want[channel]; }
};

Means compare(const Image& image, const std::function<glm::vec3(glm::vec3 towardEye)>& expected) {
    Means means;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const glm::vec3 d = -pixelDirection(kAbove, x, y, image.width, image.height);
            means.got += image.at(x, y);
            means.want += expected({d.x, -d.z, d.y});
        }
    return means;
}

/// Midpoint rule over the hemisphere of `value`(local direction), 1/sr.
template <typename Value>
glm::dvec3 overHemisphere(const Value& value) {
    constexpr int kSteps = 128;
    glm::dvec3 sum(0);
    for (int i = 0; i < kSteps * kSteps; ++i) {
        const glm::vec2 square = (glm::vec2(i % kSteps, i / kSteps) + 0.5f) / float(kSteps);
        sum += glm::dvec3(value(squareToHemisphere(square)));
    }
    return sum * (2 * double(kPi) / (kSteps * kSteps));
}

const glm::vec3 kFurnace(1.5f, 0.75f, 3.0f);  // exact in RGB9E5

// Some 8,000 of the PHATexels are seen. E = 2 pi L cos has a standard deviation of .58 of its mean, the
// lobes' f E of 1.5 at most: standard errors of .6 and 1.5 %.
TEST_F(RendererPaper, UniformDirectionsReflectTheAlbedo) {
    for (const Material& material : {metal(0.6f), metal(1), coatedPlastic()}) {
        const RendererWorld world =
            floorWith(material, uniformGuide(), [](glm::vec3, glm::vec3) { return kFurnace; });
        Renderer renderer(world.input(), kShaderFolder);
        const Material& m = world.scene.materials[0];
        Brdf brdf;
        brdf.diffuseColor = glm::vec3(m.baseColor) * (1 - m.metallic) * (1 - meanFresnel(0.04f, 1));
        brdf.f0 = glm::mix(glm::vec3(0.04f), glm::vec3(m.baseColor), m.metallic);
        brdf.alpha = m.roughness * m.roughness;
        brdf.clearcoat = m.clearcoat;
        brdf.clearcoatAlpha = m.clearcoatRoughness * m.clearcoatRoughness;
        const Means glossy =
            compare(renderer.render(frame(Method::phatPaper, Component::glossyIndirect)), [&](glm::vec3 eye) {
                Brdf specular = brdf;
                specular.diffuseColor = glm::vec3(0);
                return kFurnace * reflectance(specular, eye);
            });
        const Means all = compare(renderer.render(frame(Method::phatPaper, Component::indirect)),
                                  [&](glm::vec3 eye) { return kFurnace * reflectance(brdf, eye); });
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(glossy.ratio(c), 1, 0.045);
            EXPECT_NEAR(all.ratio(c), 1, 0.045);
        }
    }
}

// Directions drawn by the cosine, weighed as if they were uniform: 2 pi times the integral of cos^2 / pi,
// which is 4/3 of the diffuse light. The same PHATexels by their densities are right.
TEST_F(RendererPaper, CosineDirectionsAreAThirdTooBright) {
    Material half = lambert(0.5f);
    RendererWorld world = floorWith(half, cosineGuide(), [](glm::vec3, glm::vec3) { return kFurnace; });
    Renderer diffuse(world.input(), kShaderFolder);
    const Means lambertian = compare(diffuse.render(frame(Method::phatPaper, Component::diffuseIndirect)),
                                     [&](glm::vec3) { return 0.5f * kFurnace; });
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(lambertian.ratio(c), 4.0 / 3.0, 0.025);

    world = floorWith(metal(0.6f), cosineGuide(), [](glm::vec3, glm::vec3) { return kFurnace; });
    Renderer glossy(world.input(), kShaderFolder);
    const auto albedo = [&](glm::vec3 eye) {
        return kFurnace * specularAlbedo(glm::vec3(metal(0.6f).baseColor), 1, 0.36f, eye.z);
    };
    const Means paper = compare(glossy.render(frame(Method::phatPaper, Component::glossyIndirect)), albedo);
    const Means pyramid =
        compare(glossy.render(frame(Method::phatPyramid, Component::glossyIndirect)), albedo);
    const Brdf brdf{.diffuseColor = glm::vec3(0), .f0 = glm::vec3(metal(0.6f).baseColor), .alpha = 0.36f};
    const glm::vec3 eye = glm::normalize(glm::vec3(0, 0.6f, 3));
    const glm::dvec3 tooBright =
        overHemisphere([&](glm::vec3 w) { return 2 * w.z * evaluateBrdf(brdf, eye, w); }) /
        glm::dvec3(specularAlbedo(brdf.f0, 1, brdf.alpha, eye.z));
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(pyramid.ratio(c), 1, 2e-3);
        EXPECT_NEAR(paper.ratio(c), tooBright[c], 0.045 * tooBright[c]);
        EXPECT_GT(paper.ratio(c), 1.4);
    }
}

// Directions as photons bring them, p = L cos / E: bright ones count by their number and again by their
// value.
TEST_F(RendererPaper, PhotonDirectionsAreFarTooBright) {
    const auto lightOf = [](float cosine) { return cosine > 0.9f ? 16.0f : 1.0f; };
    std::array<float, kGuideCells> cells;
    for (int i = 0; i < kGuideCells; ++i) {
        const glm::vec2 middle = (glm::vec2(i % kGuideSize, i / kGuideSize) + 0.5f) / float(kGuideSize);
        const float cosine = squareToHemisphere(middle).z;
        cells[size_t(i)] = lightOf(cosine) * cosine;
    }
    const Guide guide = makeGuide(cells, 0);
    const RendererWorld world =
        floorWith(lambert(0.5f), guide, [&](glm::vec3, glm::vec3 d) { return glm::vec3(lightOf(d.y)); });
    Renderer renderer(world.input(), kShaderFolder);
    const double irradiance = overHemisphere([&](glm::vec3 w) { return glm::vec3(lightOf(w.z) * w.z); }).x;
    const double paper = overHemisphere([&](glm::vec3 w) {
                             return glm::vec3(2 * kPi * squareToGuidePdf(guide, w) * lightOf(w.z) * w.z);
                         }).x;
    const Means means = compare(renderer.render(frame(Method::phatPaper, Component::diffuseIndirect)),
                                [&](glm::vec3) { return glm::vec3(0.5f * float(irradiance) / kPi); });
    EXPECT_NEAR(means.ratio(0), paper / irradiance, 0.03 * paper / irradiance);
    EXPECT_GT(means.ratio(0), 4.5);
}

}  // namespace
}  // namespace phat::test
