#include "core/render/picture.h"

#include <atomic>

#include "core/base/parallel.h"
#include "core/base/stopwatch.h"

namespace phat {
namespace {

// Sums in double: thousands of bright samples must not absorb the dark ones.
struct PixelSums {
    glm::dvec3 value{0};
    glm::dvec3 square{0};  // of the batches' sums, over their sizes
    glm::dvec3 batch{0};   // of the batch under way

    void endBatch(int size) {
        value += batch;
        square += batch * batch / double(size);
        batch = glm::dvec3(0);
    }
};

constexpr size_t kRangePixels = 64;

// Under a time limit, progress is in milliseconds, not samples.
class ClockProgress : public Progress {
  public:
    ClockProgress(Progress& progress, uint64_t totalMs) : progress_(progress), totalMs_(totalMs) {}
    void begin(const char* stage, uint64_t) override { progress_.begin(stage, totalMs_); }
    void end() override { progress_.end(); }
    bool stopRequested() const override { return progress_.stopRequested(); }
    void advance(uint64_t) override {
        const uint64_t ms = std::min(totalMs_, uint64_t(1e3 * start_.seconds()));
        uint64_t shown = shownMs_.load();
        while (shown < ms)
            if (shownMs_.compare_exchange_weak(shown, ms)) return progress_.advance(ms - shown);
    }

  private:
    Progress& progress_;
    const uint64_t totalMs_;
    const Stopwatch start_;
    std::atomic<uint64_t> shownMs_{0};
};

// Stratification gains with the size of a batch, the estimate of the variance with their number. Of 128
// samples of tabletop, one batch has 10 % less relMSE than 128 batches; 8 and 16 batches have as little as
// one.
constexpr int kBatches = 16;
// How many samples there will be is not known under a time limit.
constexpr int kTimedBatch = 8;

// How a pixel's samples are shared out to batches: all of one size, or of two that differ by one.
struct Batches {
    explicit Batches(const PictureSettings& settings) {
        if (settings.seconds > 0) {
            samples = kTimedBatch;
            perSamples = 1;
        } else {
            samples = settings.samplesPerPixel;
            perSamples = samples / ((samples + kBatches - 1) / kBatches);
        }
    }

    int of(int sample) const { return int(int64_t(sample) * perSamples / samples); }
    int first(int batch) const { return int((int64_t(batch) * samples + perSamples - 1) / perSamples); }

    int samples = 1, perSamples = 1;  // that many batches for so many samples
};

// Of the mean of `samples`. Batches' sums are weighed by their size; a last one that a time limit cut short
// is less stratified than the others and makes the estimate too large rather than too small.
glm::dvec3 varianceOfMean(const PixelSums& sums, int samples, int batches) {
    if (batches < 2) return glm::dvec3(0);
    const glm::dvec3 spread =
        glm::max(sums.square - sums.value * sums.value / double(samples), glm::dvec3(0));
    return spread / (double(samples) * (batches - 1));
}

}  // namespace

CameraRay cameraRay(const Camera& camera, int width, int height, glm::vec2 position) {
    const float aspect = float(width) / float(height);
    const glm::vec2 ndc(2 * position.x / float(width) - 1, 1 - 2 * position.y / float(height));
    const glm::mat3 rotation(camera.worldFromCamera);
    const glm::vec3 eye(camera.worldFromCamera[3]);
    const float nearMeters = std::max(camera.znear, 0.0f);
    if (camera.perspective) {
        const float half = std::tan(0.5f * camera.yfovRadians);
        const glm::vec3 toPlane = rotation * glm::vec3(ndc.x * half * aspect, ndc.y * half, -1);
        return {eye + nearMeters * toPlane, glm::normalize(toPlane)};
    }
    const glm::vec3 onPlane(ndc.x * camera.ymag * aspect, ndc.y * camera.ymag, -nearMeters);
    return {eye + rotation * onPlane, glm::normalize(rotation * glm::vec3(0, 0, -1))};
}

Hit visibleHit(const RayScene& rays, const CameraRay& ray, uint64_t& rayCount) {
    const Scene& scene = rays.scene();
    glm::vec3 origin = ray.origin;
    for (;;) {
        ++rayCount;
        Hit hit = rays.closestHit(origin, ray.direction);
        if (!hit) return hit;
        const glm::vec3 position = origin + hit.distance * ray.direction;
        if (!hit.backFace || scene.materialOf(hit.triangle).doubleSided) {
            hit.distance = glm::distance(ray.origin, position);
            return hit;
        }
        const glm::uvec3 corner = scene.triangles[hit.triangle];
        const glm::vec3 a = scene.positions[corner.x];
        const glm::vec3 front = glm::cross(scene.positions[corner.y] - a, scene.positions[corner.z] - a);
        const glm::vec3 beyond = rays.offsetOrigin(position, glm::normalize(front));
        // Where floats are too coarse to get past it, the ray ends rather than stays.
        if (!(glm::dot(beyond - origin, ray.direction) > 0)) return {};
        origin = beyond;
    }
}

SeenThrough visibleThrough(const RayScene& rays, const CameraRay& ray, PixelSample& sample) {
    const Ray seen{ray.origin, ray.direction};
    if (!rays.hasGlass()) return {visibleHit(rays, ray, sample.rays), seen};
    ++sample.rays;
    // Samples of one pixel may have the same ray.
    return seeThrough(rays, seen, sample.rng.bits64(), sample.rays, SeenSides::visible);
}

TracedPicture tracePicture(const PictureSettings& settings, const Integrator& integrator,
                           Progress& callersProgress) {
    const Stopwatch start;
    const size_t pixelCount = size_t(settings.width) * size_t(settings.height);
    const bool all = settings.pixels.empty();
    std::vector<PixelSums> sums(all ? pixelCount : settings.pixels.size());
    const auto pixelOf = [&](size_t i) { return all ? i : size_t(settings.pixels[i]); };
    const bool timed = settings.seconds > 0;
    ClockProgress clock(callersProgress, uint64_t(settings.seconds * 1e3));
    Progress& progress = timed ? clock : callersProgress;
    // A pass ends soon enough to look at the clock, and is long enough not to wait for its slowest pixels.
    const int perPass = timed ? 1 : std::min(settings.samplesPerPixel, 16);
    const int passes = (settings.samplesPerPixel + perPass - 1) / perPass;
    const Batches batches(settings);
    std::atomic<uint64_t> rays{0};

    progress.begin("trace", uint64_t(sums.size()) * uint64_t(passes));
    int done = 0;
    while (timed ? done == 0 || start.seconds() < settings.seconds : done < settings.samplesPerPixel) {
        const int end = timed ? done + 1 : std::min(done + perPass, settings.samplesPerPixel);
        parallelRanges(sums.size(), kRangePixels, progress, [&](size_t first, size_t last) {
            uint64_t rangeRays = 0;
            for (size_t i = first; i < last; ++i) {
                const size_t pixel = pixelOf(i);
                const glm::vec2 corner(pixel % size_t(settings.width), pixel / size_t(settings.width));
                for (int index = done; index < end; ++index) {
                    const int batch = batches.of(index), begin = batches.first(batch);
                    PixelSample sample{
                        Rng(hashOf(settings.seed, pixel, uint64_t(index))),
                        PathNumbers(hashOf(~settings.seed, pixel, uint64_t(batch)), uint32_t(index - begin))};
                    const glm::vec2 inPixel(sample.numbers.next4());
                    const glm::vec2 position =
                        corner + (settings.filter == PixelFilter::box ? inPixel : glm::vec2(0.5f));
                    sums[i].batch += glm::dvec3(integrator(
                        cameraRay(settings.camera, settings.width, settings.height, position), sample));
                    if (batches.of(index + 1) != batch) sums[i].endBatch(index + 1 - begin);
                    rangeRays += sample.rays;
                }
            }
            rays += rangeRays;
        });
        done = end;
    }
    progress.end();

    TracedPicture picture{Image(settings.width, settings.height), Image(settings.width, settings.height),
                          done, rays};
    const int started = done - batches.first(batches.of(done));  // of a batch that the time limit cut short
    for (size_t i = 0; i < sums.size(); ++i) {
        if (started > 0) sums[i].endBatch(started);
        picture.mean.pixels[pixelOf(i)] = glm::vec3(sums[i].value / double(done));
        picture.variance.pixels[pixelOf(i)] =
            glm::vec3(varianceOfMean(sums[i], done, batches.of(done - 1) + 1));
    }
    return picture;
}

}  // namespace phat
