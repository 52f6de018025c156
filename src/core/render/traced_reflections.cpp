#include "core/render/traced_reflections.h"

#include <atomic>
#include <bit>

#include "core/base/parallel.h"
#include "core/render/lobe_rays.h"
#include "core/scene/brdf.h"

namespace phat {
namespace {

// Rays for a neighbourhood in all frames together, and at least in each frame. A mirror needs one ray; the
// number grows with the lobe's width in radians, some 2 alpha. A pixel traces at most a fraction of them.
constexpr float kRaysPerNeighborhood = 64, kMinRaysPerFrame = 8;
constexpr float kRaysPerAlpha = 800;
constexpr float kMaxOwnFraction = 0.5f;
// Where at least so many pooled rays count for each traced one, 4x4 pixels share one sequence.
constexpr float kSharedFrom = 4;
// From glossy hits, walks continue: their number per neighbourhood and frame.
constexpr float kWalks = 8;
constexpr uint64_t kStream = 0x5e1f;  // of hashOf
constexpr size_t kGrain = 64;

// Barycentric coordinates of the point that a pixel shows. By rounding, the ray may miss a triangle that the
// rasteriser drew; then the nearest point of the triangle.
glm::vec2 barycentricOn(const Scene& scene, uint32_t triangle, const Ray& ray) {
    const glm::uvec3 t = scene.triangles[triangle];
    const glm::dvec3 a(scene.positions[t.x]);
    const glm::dvec3 ab = glm::dvec3(scene.positions[t.y]) - a, ac = glm::dvec3(scene.positions[t.z]) - a;
    const glm::dvec3 direction(ray.direction), from = glm::dvec3(ray.origin) - a;
    // source: Moeller and Trumbore 1997, "Fast, Minimum Storage Ray-Triangle Intersection".
    const glm::dvec3 p = glm::cross(direction, ac);
    const double determinant = glm::dot(ab, p);
    if (determinant == 0) return glm::vec2(1.0f / 3.0f);
    const double u = std::clamp(glm::dot(from, p) / determinant, 0.0, 1.0);
    const double v = std::clamp(glm::dot(direction, glm::cross(from, ab)) / determinant, 0.0, 1.0);
    return glm::vec2(glm::dvec2(u, v) / std::max(u + v, 1.0));
}

// A power of two, so that frames whose jitter changes the count still continue one sequence. `raysForOne`:
// the pool's.
int rayCountFor(const TracedLobe& lobe, float raysForOne, int pictures) {
    const float perNeighborhood = std::max(kRaysPerNeighborhood / float(pictures), kMinRaysPerFrame);
    // Lobes that the lookup resolves in part need fewer.
    const float own = std::min({perNeighborhood * lobe.weight / raysForOne, kRaysPerAlpha * lobe.alpha,
                                kMaxOwnFraction * perNeighborhood});
    return int(std::bit_ceil(uint32_t(std::max(std::ceil(own), 1.0f))));
}

// The primary ray of a pixel and its hit.
struct PrimaryRay {
    glm::vec3 direction{0};  // from the eye, world
    glm::vec2 barycentric{0};
};

// Traces all lobes of a kind, base or coat, whose weight is not 0. Each step takes what the one before it
// found for all of them, [0, count()).
class LobeTracer {
  public:
    LobeTracer(const ReflectionScene& scene, const ReflectionView& view,
               std::span<const TracedSurface> surfaces, std::span<const PrimaryRay> primaryRays,
               TracedLobe TracedSurface::*lobe, uint64_t kind)
        : scene_(scene),
          view_(view),
          surfaces_(surfaces),
          primaryRays_(primaryRays),
          lobe_(lobe),
          kind_(kind),
          traced_(tracedOf(surfaces, lobe)),
          pool_(pooledLobes(), view.width, view.height) {}

    size_t count() const { return traced_.size(); }
    uint32_t surfaceOf(size_t i) const { return traced_[i]; }

    TracedLight trace(size_t i, uint64_t& rayCount) const {
        const TracedSurface& s = surfaces_[traced_[i]];
        const PrimaryRay& primary = primaryRays_[traced_[i]];
        const TracedLobe& lobe = s.*lobe_;
        LobeRays rays{scene_, view_, rayCount,
                      surfaceAt(scene_.rays.scene(), s.triangle, primary.barycentric, s.back)};
        rays.point.shading = frameFromNormal(lobe.normal);
        rays.point.brdf = Brdf{};
        rays.point.brdf.f0 = glm::vec3(lobe.f0);
        rays.point.brdf.f90 = lobe.f90;
        rays.point.brdf.alpha = lobe.alpha;
        rays.eyeLocal = rays.point.shading.toLocal(-primary.direction);
        rays.albedo = specularAlbedo(rays.point.brdf.f0, lobe.f90, lobe.alpha, rays.eyeLocal.z).x;
        if (rays.albedo <= 0.0f) return {};
        if (view_.filter == PixelFilter::box) rays.steps = pool_.steps(i);
        const float raysForOne = pool_.raysForOne(i);
        const int count = rayCountFor(lobe, raysForOne, view_.pictures);
        const int walks = std::max(int(kWalks / (raysForOne * float(count))), 1);
        const uint64_t stream = hashOf(kStream, s.pixel) + kind_;
        TracedLight found = rays.trace(count, walks, numbersFor(s.pixel, stream, count, raysForOne), stream);
        found.gloss.lobe.pixel = s.pixel;
        return found;
    }

    LobeIncident incident(size_t i, const std::vector<PooledLight>& lights,
                          const std::vector<ReflectionPool::Redistribution>& redistributions) const {
        const PooledLight light = pool_.pooled(i, lights, redistributions);
        return {light.indirect, light.area,
                light.weight > 0.0f ? (surfaces_[traced_[i]].*lobe_).weight : 0.0f};
    }
    const ReflectionPool& pool() const { return pool_; }

  private:
    static std::vector<uint32_t> tracedOf(std::span<const TracedSurface> surfaces,
                                          TracedLobe TracedSurface::*lobe) {
        std::vector<uint32_t> traced;
        for (uint32_t i = 0; i < surfaces.size(); ++i)
            if ((surfaces[i].*lobe).weight > 0) traced.push_back(i);
        return traced;
    }

    // Where rays are pooled, 4x4 pixels take turns in one sequence, in another order in every frame, so that
    // their rays are stratified together.
    RayNumbers numbersFor(uint32_t pixel, uint64_t stream, int count, float raysForOne) const {
        const uint32_t first = view_.frame * uint32_t(count);
        if (raysForOne < kSharedFrom) return {uint32_t(stream), first, 1};
        const uint32_t x = pixel % uint32_t(view_.width), y = pixel / uint32_t(view_.width);
        const uint32_t rank = (4 * (y & 3) + (x & 3)) ^ (view_.frame & 15);
        return {uint32_t(hashOf(kStream, kind_)), 16 * first + rank, 16};
    }

    std::vector<PooledLobe> pooledLobes() const {
        const Scene& scene = scene_.rays.scene();
        std::vector<PooledLobe> lobes;
        for (const uint32_t i : traced_) {
            const TracedSurface& s = surfaces_[i];
            const TracedLobe& lobe = s.*lobe_;
            lobes.push_back({s.pixel, 2 * scene.triangleSurface[s.triangle] + uint32_t(s.back),
                             positionAt(scene, s.triangle, primaryRays_[i].barycentric),
                             -primaryRays_[i].direction, glm::reflect(primaryRays_[i].direction, lobe.normal),
                             lobe.alpha, std::max(lobe.distance, 1e-3f * scene_.rays.unitMeters())});
        }
        return lobes;
    }

    const ReflectionScene& scene_;
    const ReflectionView& view_;
    const std::span<const TracedSurface> surfaces_;
    const std::span<const PrimaryRay> primaryRays_;
    TracedLobe TracedSurface::*const lobe_;
    const uint64_t kind_;
    const std::vector<uint32_t> traced_;  // indices of surfaces
    const ReflectionPool pool_;
};

// What was spread of the brightest of `lights`, see ReflectionPool.
std::vector<ReflectionPool::Redistribution> redistributed(const ReflectionPool& pool,
                                                          const std::vector<PooledLight>& lights) {
    std::vector<ReflectionPool::Redistribution> found(lights.size());
    SilentProgress silent;
    parallelRanges(lights.size(), kGrain, silent, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) found[i] = pool.redistribute(i, lights);
    });
    return found;
}

// The light of all lobes, each with what it shares with others of the light on what their rays hit.
std::vector<PooledLight> withGloss(const std::vector<TracedLight>& traced, const ReflectionView& view) {
    std::vector<PooledLobe> lobes;
    std::vector<PooledLight> onHits, lights;
    for (const TracedLight& t : traced) {
        lobes.push_back(t.gloss.lobe);
        onHits.push_back(t.gloss.light);
        lights.push_back(t.light);
    }
    const ReflectionPool pool(std::move(lobes), view.width, view.height);
    const auto redistributions = redistributed(pool, onHits);
    SilentProgress silent;
    parallelRanges(lights.size(), kGrain, silent, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            if (traced[i].gloss.lobe.alpha > 0)
                lights[i].indirect +=
                    traced[i].gloss.carried * pool.pooled(i, onHits, redistributions).indirect;
    });
    return lights;
}

}  // namespace

std::vector<SurfaceIncident> traceReflections(const ReflectionScene& scene, const ReflectionView& view,
                                              std::span<const TracedSurface> surfaces, Progress& progress,
                                              uint64_t& rayCount) {
    splitSumTable();  // integrated here, so that no thread waits for it
    std::vector<PrimaryRay> primaryRays;
    for (const TracedSurface& s : surfaces) {
        const Ray eye = cameraRay(view.camera, view.width, view.height, s.position);
        primaryRays.push_back({eye.direction, barycentricOn(scene.rays.scene(), s.triangle, eye)});
    }
    const LobeTracer base(scene, view, surfaces, primaryRays, &TracedSurface::base, 0);
    const LobeTracer coat(scene, view, surfaces, primaryRays, &TracedSurface::coat, 1);

    std::vector<SurfaceIncident> incident(surfaces.size());
    std::atomic<uint64_t> rays{0};
    const ProgressStage stage(progress, "reflections", base.count() + coat.count());
    const auto trace = [&](const LobeTracer& lobes, LobeIncident SurfaceIncident::*lobe) {
        std::vector<TracedLight> traced(lobes.count());
        parallelRanges(lobes.count(), kGrain, progress, [&](size_t begin, size_t end) {
            uint64_t rangeRays = 0;
            for (size_t i = begin; i < end; ++i) traced[i] = lobes.trace(i, rangeRays);
            rays += rangeRays;
        });
        const std::vector<PooledLight> lights = withGloss(traced, view);
        const auto redistributions = redistributed(lobes.pool(), lights);
        SilentProgress silent;
        parallelRanges(lobes.count(), kGrain, silent, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i)
                incident[lobes.surfaceOf(i)].*lobe = lobes.incident(i, lights, redistributions);
        });
    };
    trace(base, &SurfaceIncident::base);
    trace(coat, &SurfaceIncident::coat);
    rayCount += rays;
    return incident;
}

}  // namespace phat
