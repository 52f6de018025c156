// Rays that the GPU traces under an environment, whose bright parts light samples find.

#include <gtest/gtest.h>

#include "core/scene/brdf.h"
#include "core/scene/environment_sampling.h"
#include "gl/traced_world.h"

namespace phat::test {
namespace {

constexpr int kWidth = 64, kHeight = 32;
const glm::vec3 kEye(0, 1, 1), kMiddle(0.1f, 0, 0);

/// One radiance everywhere, and another in a texel near where a floor mirrors it.
Environment skyWithSun(float sky, float sun) {
    Environment environment{Image(kWidth, kHeight)};
    for (glm::vec3& radiance : environment.radiance.pixels) radiance = glm::vec3(sky);
    environment.radiance.at(kWidth / 4, kHeight / 4) = glm::vec3(sun);  // toward -Z, 45 degrees up
    return environment;
}

/// Of its middle.
GpuWorld floorUnder(const Environment& environment, float roughness) {
    Scene scene;
    addFloor(scene, whiteMetal(roughness), 8);
    scene.environment = environment;
    return GpuWorld(std::move(scene));
}

// What white metal reflects of all of an environment toward an eye, by integration over directions.
double reflectedOf(const Environment& environment, float roughness, glm::vec3 normal, glm::vec3 toward) {
    const Frame frame = frameFromNormal(normal);
    const glm::vec3 towardEye = frame.toLocal(glm::normalize(toward));
    Brdf brdf;
    brdf.f0 = glm::vec3(1);
    brdf.alpha = square(roughness);
    constexpr int kSteps = 16 * kHeight;
    double sum = 0;
    for (int y = 0; y < kSteps; ++y)
        for (int x = 0; x < 2 * kSteps; ++x) {
            const float polar = (float(y) + 0.5f) * kPi / kSteps, azimuth = (float(x) + 0.5f) * kPi / kSteps;
            const glm::vec3 d(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                              std::sin(polar) * std::sin(azimuth));
            if (glm::dot(d, normal) <= 0) continue;
            const double solidAngle = double(square(kPi / kSteps) * std::sin(polar));
            sum += solidAngle * double(environmentRadiance(environment, d).x) *
                   double(evaluateBrdf(brdf, towardEye, frame.toLocal(d)).x);
        }
    return sum;
}

double reflectedOf(const Environment& environment, float roughness) {
    return reflectedOf(environment, roughness, {0, 1, 0}, kEye - kMiddle);
}

struct MeanAndNoise {
    double mean = 0, noise = 0;  // the latter: root mean square over the pixels, relative to the mean
};
MeanAndNoise seenBy(GpuWorld sky, int samples) {
    sky.frame.camera = lookAtCamera(kEye, kMiddle, 0.5f);
    sky.frame.component = Component::direct;
    sky.frame.samplesPerPixel = samples;
    Renderer renderer(sky.input(), kShaderFolder);
    const Image image = renderer.render(sky.frame);
    MeanAndNoise found;
    for (const glm::vec3& pixel : image.pixels) found.mean += double(pixel.x) / double(image.pixels.size());
    for (const glm::vec3& pixel : image.pixels)
        found.noise += square(double(pixel.x) / found.mean - 1) / double(image.pixels.size());
    found.noise = std::sqrt(found.noise);
    return found;
}

// Rays and light samples share the sun's light at every width of the lobe. Neither alone has the mean.
TEST(GpuSky, SunBringsItsShareOfTheLobe) {
    const Environment environment = skyWithSun(0.5f, 200);
    for (const float roughness : {0.1f, 0.3f, 0.5f, 0.8f}) {
        const double expected = reflectedOf(environment, roughness);
        EXPECT_NEAR(seenBy(floorUnder(environment, roughness), 64).mean, expected, 0.02 * expected)
            << roughness;
    }
}

// In one frame a rough lobe's few rays miss the sun in most pixels.
TEST(GpuSky, OneFrameShowsTheSunWithoutFireflies) {
    const Environment environment = skyWithSun(0.1f, 2000);
    const MeanAndNoise one = seenBy(floorUnder(environment, 0.6f), 1);
    const double expected = reflectedOf(environment, 0.6f);
    EXPECT_NEAR(one.mean, expected, 0.05 * expected);
    EXPECT_LT(one.noise, 0.1);
}

// The cells of large pictures have several texels, the last ones fewer.
TEST(GpuSky, LargePicturesAreSampledByCells) {
    constexpr int kScale = 27;  // 1,728 x 864: cells of 2x2
    const Environment small = skyWithSun(0.5f, 200);
    Environment large{Image(kScale * kWidth + 1, kScale * kHeight + 1)};
    for (int y = 0; y < large.radiance.height; ++y)
        for (int x = 0; x < large.radiance.width; ++x)
            large.radiance.at(x, y) =
                small.radiance.at(std::min(x / kScale, kWidth - 1), std::min(y / kScale, kHeight - 1));
    const double expected = reflectedOf(large, 0.5f);
    EXPECT_NEAR(seenBy(floorUnder(large, 0.5f), 16).mean, expected, 0.02 * expected);
}

// Interpolated normals that turn away from the eye, as at the silhouettes of coarse meshes.
TEST(GpuSky, MirrorsAreNotBlackWhereTheyWouldShowWhatIsUnderTheTriangle) {
    Scene scene;
    addFloor(scene, whiteMetal(0), 8);
    for (glm::vec3& normal : scene.normals) normal = glm::normalize(glm::vec3(0, 1, -0.27f));
    scene.environment = skyWithSun(1, 1);
    GpuWorld gpu(std::move(scene));
    gpu.frame.camera = lookAtCamera({0, 0.34f, 0.94f}, {0, 0, 0}, 2);
    Renderer renderer(gpu.input(), kShaderFolder);
    EXPECT_NEAR(gpu.middle(renderer, Component::direct), 1, 0.02f);
}

// A ray far from the peak of a mirror's lobe would be all that its pixel shows.
TEST(GpuSky, MirrorsHaveNoSpecks) {
    for (const bool bright : {true, false}) {
        GpuWorld gpu = floorUnder(skyOfHalves(bright ? 10.0f : 0.1f, bright ? 0.1f : 10.0f), 0.05f);
        gpu.frame.camera = lookAtCamera(kEye, kMiddle, 0.5f);
        gpu.frame.component = Component::direct;
        gpu.frame.samplesPerPixel = 1;
        gpu.frame.width = 192;
        gpu.frame.height = 144;
        Renderer renderer(gpu.input(), kShaderFolder);
        float least = 1e9f, most = 0;
        for (const glm::vec3& pixel : renderer.render(gpu.frame).pixels) {
            least = std::min(least, pixel.x);
            most = std::max(most, pixel.x);
        }
        EXPECT_GT(least, 0.99f * most);
    }
}

// A rough metal wall that a mirror shows: its PHATexels know nothing of the sky.
TEST(GpuSky, MirrorShowsWhatMetalsReflectOfIt) {
    Environment environment = skyWithSun(0.5f, 0.5f);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            if (y >= kHeight / 2) environment.radiance.at(x, y) = glm::vec3(0);
    environment.radiance.at(3 * kWidth / 4, kHeight / 4) = glm::vec3(300);  // toward +Z, 45 degrees up
    Scene scene;
    addFloor(scene, whiteMetal(0), 8);
    addQuad(scene, whiteMetal(0.4f), {-4, 0, -3}, {8, 0, 0}, {0, 8, 0});
    scene.environment = environment;
    GpuWorld gpu(std::move(scene));
    fillWithLookups(gpu.world, 0, 0.05f);
    gpu.frame.camera = lookAtCamera(kEye, kMiddle, 0.5f);
    gpu.frame.samplesPerPixel = 16;
    Renderer renderer(gpu.input(), kShaderFolder);
    const glm::vec3 arriving = glm::reflect(kMiddle - kEye, glm::vec3(0, 1, 0));
    const double expected = reflectedOf(environment, 0.4f, {0, 0, 1}, -arriving);
    EXPECT_NEAR(gpu.middle(renderer, Component::glossyIndirect), expected, 0.05 * expected);
}

}  // namespace
}  // namespace phat::test
