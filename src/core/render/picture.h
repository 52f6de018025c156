#pragma once
// Pictures by casting rays from a camera: the frame around every CPU renderer.

#include <functional>

#include "core/base/image.h"
#include "core/base/progress.h"
#include "core/base/random.h"
#include "core/scene/camera_ray.h"
#include "core/scene/glass.h"
#include "core/scene/scene.h"
#include "core/transport/path_numbers.h"

namespace phat {

/// Parts of a picture. `direct` is light that was never reflected before it met the visible surface, with
/// directly visible emission; the others are the rest, by the lobe of the visible surface that reflects it.
enum class Component : uint8_t { all, direct, indirect, glossyIndirect, diffuseIndirect };

/// One sample of one pixel, beside its ray.
struct PixelSample {
    Rng rng;  // its own
    /// Of its path, stratified with other samples of the pixel.
    PathNumbers numbers{Rng(Rng(rng).bits64())};
    uint64_t rays = 0;  // traced for it; the integrator counts
};

/// The same behind glass: one of the ways that light goes there (seeThrough), chosen by the sample's numbers.
SeenThrough visibleThrough(const RayScene& rays, const Ray& ray, PixelSample& sample);

enum class PixelFilter : uint8_t { box, center };

/// Radiance that arrives along a ray.
using Integrator = std::function<glm::vec3(const Ray& ray, PixelSample& sample)>;

struct PictureSettings {
    int width = 640;
    int height = 360;
    Camera camera;
    int samplesPerPixel = 64;  // at most 65536
    double seconds = 0;        // > 0: stop after the pass that ends past this time, however many samples
    uint64_t seed = 1;
    /// The support of a pixel's filter: its square, or its centre, as in a rasterised frame without
    /// anti-aliasing shows.
    PixelFilter filter = PixelFilter::box;
    std::vector<uint32_t> pixels;  // y * width + x of those to trace; the others stay black. Empty: all
};

struct TracedPicture {
    Image mean;
    Image variance;  // of the mean, per channel, from the batches' spread; 0 for a single batch
    int samplesPerPixel = 0;
    uint64_t rays = 0;
};

/// Averages `integrator` over each pixel, in passes over the whole picture. A
/// pixel's samples come in batches: those of one are stratified together, batches are independent. The same
/// bytes for any number of threads, unless a time limit decides the number of samples. Throws Interrupted
/// when `progress` requests it.
TracedPicture tracePicture(const PictureSettings& settings, const Integrator& integrator, Progress& progress);

}  // namespace phat
