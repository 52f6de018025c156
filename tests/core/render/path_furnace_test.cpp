// The path tracer in rooms whose light is known in every direction.

#include <gtest/gtest.h>

#include "core/render/path_tracer.h"
#include "io/gltf/gltf_loader.h"

namespace phat {
namespace {

Scene load(const std::string& name) {
    return loadGltf(PHAT_SOURCE_DIR "/scenes/" + name).scene;
}

TracedPicture trace(const Scene& scene, int width, int height, int samples) {
    const RayScene rays(scene);
    const LightSampler lights(scene);
    PictureSettings settings;
    settings.width = width;
    settings.height = height;
    settings.camera = scene.cameras.at(0);
    settings.samplesPerPixel = samples;
    SilentProgress silent;
    return tracePicture(settings, pathTracer(rays, lights, Component::all), silent);
}

struct Mean {
    double value = 0, standardError = 0;
};

// Over a part of the picture.
Mean meanOf(const TracedPicture& picture, glm::ivec2 first, glm::ivec2 size) {
    double sum = 0, variance = 0;
    const double count = double(size.x) * double(size.y);
    for (int y = first.y; y < first.y + size.y; ++y)
        for (int x = first.x; x < first.x + size.x; ++x) {
            sum += double(picture.mean.at(x, y).x);
            variance += double(picture.variance.at(x, y).x);
        }
    return {sum / count, std::sqrt(variance) / count};
}

// Albedo .5 and emission 1 nit all round: 2 nit. With its smooth normals the file loses .06 %: on coarse
// curved meshes some directions above the shading normal's horizon lie under the flat triangle, and such
// paths end (docs/reference.md, "Path tracer"). With flat normals there are none.
TEST(PathFurnace, IsTwoButForDirectionsUnderFlatTriangles) {
    Scene scene = load("furnace.glb");
    const TracedPicture smooth = trace(scene, 64, 36, 512);
    for (glm::vec3& normal : scene.normals) normal = glm::vec3(0);  // read as: the flat triangle's
    const TracedPicture flat = trace(scene, 64, 36, 512);
    const Mean exact = meanOf(flat, {0, 0}, {64, 36}), lossy = meanOf(smooth, {0, 0}, {64, 36});
    EXPECT_LT(exact.standardError, 3e-4) << "the test tells nothing";
    EXPECT_NEAR(exact.value, 2, 4 * exact.standardError);
    EXPECT_LT(lossy.value, 2 + 4 * lossy.standardError);
    EXPECT_GT(lossy.value, 2 * (1 - 1e-3) - 4 * lossy.standardError);
}

// What a pixel shows if all light that arrives is 1 nit: its albedo, or the wall.
double visibleAlbedo(const RayScene& rays, const Scene& scene, int x, int y, int width, int height) {
    constexpr int kSide = 4;
    double sum = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const glm::vec2 position = glm::vec2(x, y) + (glm::vec2(i % kSide, i / kSide) + 0.5f) / float(kSide);
        uint64_t count = 0;
        const Ray ray = cameraRay(scene.cameras.at(0), width, height, position);
        const Hit hit = visibleHit(rays, ray, count);
        if (!hit) continue;
        const SurfacePoint point = surfaceAt(scene, hit, ray.direction);
        sum += double(point.emission.x + reflectance(point.brdf, point.shading.toLocal(-ray.direction)).x);
    }
    return sum / (kSide * kSide);
}

// White metals and dielectrics in 1 nit from everywhere: they show their albedo, and none gains light.
// Neighbours that have lost light show in them, so it is a bit less.
TEST(PathFurnace, GlossySpheresShowTheirAlbedo) {
    const Scene scene = load("furnace-glossy.glb");
    const RayScene rays(scene);
    constexpr int kWidth = 96, kHeight = 54, kBlock = 6;
    const TracedPicture picture = trace(scene, kWidth, kHeight, 256);
    double got = 0, want = 0, least = 1;
    for (int top = 0; top < kHeight; top += kBlock)
        for (int left = 0; left < kWidth; left += kBlock) {
            const Mean mean = meanOf(picture, {left, top}, {kBlock, kBlock});
            double albedo = 0;
            for (int y = top; y < top + kBlock; ++y)
                for (int x = left; x < left + kBlock; ++x)
                    albedo += visibleAlbedo(rays, scene, x, y, kWidth, kHeight) / (kBlock * kBlock);
            EXPECT_LE(mean.value, 1.005 + 4 * mean.standardError);
            // The table of albedos is good to 2e-3; silhouettes are seen by 16 rays a pixel.
            // of that.
            EXPECT_LE(mean.value, albedo + 0.01 + 4 * mean.standardError) << left << ' ' << top;
            // A neighbour fills less than a third of what a point sees, and the darkest shows .37 nit.
            EXPECT_GE(mean.value, 0.8 * albedo - 4 * mean.standardError) << left << ' ' << top;
            got += mean.value;
            want += albedo;
            least = std::min(least, albedo);
        }
    EXPECT_NEAR(got / want, 0.99, 0.01);
    EXPECT_LT(least, 0.45) << "no rough metal is seen";
}

}  // namespace
}  // namespace phat
