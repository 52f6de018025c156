#include "core/render/traced_reflections.h"

#include <atomic>
#include <bit>
#include <cassert>

#include "core/base/parallel.h"
#include "core/base/sobol.h"
#include "core/render/reflection_pool.h"
#include "core/scene/brdf.h"
#include "core/transport/path_vertex.h"

namespace phat {
namespace {

// Rays a lobe wants in all pictures together, its neighbours' included, and in each of them at least; for a
// mirror one, more as the lobe's width in radians, some 2 alpha, grows. At most a part of them are its own.
constexpr float kWantedRays = 64, kLeastWanted = 8;
constexpr float kRaysPerAlpha = 800;
constexpr float kMostOwn = 0.5f;
// From so many rays that count for one on, pixels share a sequence.
constexpr float kSharedFrom = 4;
// Where rays hit something glossy, walks go on from there: so many a pixel and picture, shared by its rays,
// and of so many reflections at most.
constexpr float kWalks = 8;
constexpr int kMostBounces = 8;
constexpr uint64_t kStream = 0x5e1f;  // of hashOf

// The place on the triangle that a pixel shows. Rounding may put the ray just beside a triangle that the
// rasteriser drew; the nearest place on it is meant.
glm::vec2 barycentricOn(const Scene& scene, uint32_t triangle, const CameraRay& ray) {
    const glm::uvec3 t = scene.triangles[triangle];
    const glm::dvec3 a(scene.positions[t.x]);
    const glm::dvec3 ab = glm::dvec3(scene.positions[t.y]) - a, ac = glm::dvec3(scene.positions[t.z]) - a;
    const glm::dvec3 way(ray.direction), from = glm::dvec3(ray.origin) - a;
    // source: Moeller and Trumbore 1997, "Fast, Minimum Storage Ray-Triangle Intersection".
    const glm::dvec3 p = glm::cross(way, ac);
    const double determinant = glm::dot(ab, p);
    if (determinant == 0) return glm::vec2(1.0f / 3.0f);
    const double u = std::clamp(glm::dot(from, p) / determinant, 0.0, 1.0);
    const double v = std::clamp(glm::dot(way, glm::cross(from, ab)) / determinant, 0.0, 1.0);
    return glm::vec2(glm::dvec2(u, v) / std::max(u + v, 1.0));
}

/// The points of Sobol's sequence that a pixel's rays take.
struct RayNumbers {
    uint32_t seed = 0;
    uint32_t first = 0, stride = 1;

    glm::vec2 of(int ray) const { return glm::vec2(sobol4(first + uint32_t(ray) * stride, seed)); }
};

/// A lobe as a surface of its own.
struct LobeRays {
    const ReflectionScene& scene;
    const ReflectionView& view;
    uint64_t& rayCount;
    SurfacePoint point;
    glm::vec3 eyeLocal{0};
    float albedo = 0;

    glm::vec3 seenByLightSample(Rng& rng) const;
    PooledLight trace(int count, int walks, const RayNumbers& numbers, uint64_t stream) const;
};

// Power heuristic (Veach 1997): most light samples of a sharp lobe are rare finds of what its own rays find
// surely, and should weigh nothing rather than one.
// pre: own > 0.
float powerWeight(float own, float other) {
    assert(own > 0.0f);
    return 1.0f / (1.0f + square(other / own));
}

// Of one place on the area lights, over the lobe's albedo: small lamps that the lobe's own rays seldom meet.
glm::vec3 LobeRays::seenByLightSample(Rng& rng) const {
    const float choice = rng.uniform();
    const LightSample light = scene.lights.sampleArea(point.position, choice, rng.uniform2());
    if (light.pdf <= 0.0f || maxComponent(light.radiance) <= 0.0f || !leavesSurface(point, light.towardLight))
        return glm::vec3(0);
    const glm::vec3 local = point.shading.toLocal(light.towardLight);
    const float value = evaluateBrdf(point.brdf, eyeLocal, local).x;
    if (value <= 0.0f) return glm::vec3(0);
    const float weight = powerWeight(light.pdf, sampleBrdfPdf(point.brdf, eyeLocal, local));
    // Below this no lamp is bright enough to be seen, and the shadow ray is saved.
    constexpr float kLeastWeight = 1e-6f;
    if (weight < kLeastWeight) return glm::vec3(0);
    ++rayCount;
    if (!seesLight(scene.rays, point.position, originOn(point, light.towardLight), light))
        return glm::vec3(0);
    return value * weight / light.pdf / albedo * light.radiance;
}

PooledLight LobeRays::trace(int count, int walks, const RayNumbers& numbers, uint64_t stream) const {
    const TexelWorld world{{scene.rays, scene.lights}, scene.atlas, scene.texels};
    const TexelIrradiance irradiance{scene.phatexture.indirectIrradiance, scene.phatexture.areaIrradiance,
                                     true};
    const PathSettings atHits{walks, kMostBounces};
    PooledLight seen;
    glm::vec3 sampled(0);
    for (int i = 0; i < count; ++i) {
        Rng rng(hashOf(stream, view.frame, uint64_t(i)));
        if (view.area && scene.lights.hasArea()) sampled += seenByLightSample(rng);
        const BrdfSample sample = sampleBrdf(point.brdf, eyeLocal, 0.5f, numbers.of(i));
        if (sample.pdf <= 0.0f) continue;
        const glm::vec3 direction = glm::normalize(point.shading.toWorld(sample.direction));
        if (!leavesSurface(point, direction)) continue;
        const float weight = sample.weight.x;
        seen.weight += weight;

        ++rayCount;
        const Hit hit = scene.rays.closestHit(originOn(point, direction), direction);
        const float lightPdf = areaPdf(scene.lights, point.position, hit, direction);
        const float emissionWeight = weight * powerWeight(sample.pdf, lightPdf);
        if (!hit) {
            seen.area += emissionWeight * scene.lights.environmentRadiance(direction);
            continue;
        }
        const SurfacePoint far = surfaceAt(scene.rays.scene(), hit, direction);
        seen.area += emissionWeight * far.emission;
        if (view.indirect)
            seen.indirect += weight * reflectedFromTexels(world, irradiance, {hit, far, -direction}, atHits,
                                                          rng, rayCount);
    }
    if (seen.weight <= 0.0f) return {};
    seen.indirect /= seen.weight;
    seen.area = seen.area / seen.weight + sampled / float(count);
    // A clamp: the two are independent estimates, whose noise must not exceed all light that there is.
    const glm::vec3 scale =
        glm::min(glm::vec3(1), scene.brightest / glm::max(seen.indirect + seen.area, glm::vec3(1e-20f)));
    seen.indirect *= scale;
    seen.area *= scale;
    return seen;
}

// A power of two: pictures whose jitter changes it still share one sequence. `raysForOne`: the pool's.
int rayCountFor(const TracedLobe& lobe, float raysForOne, int pictures) {
    const float wanted = std::max(kWantedRays / float(pictures), kLeastWanted);
    // What the lookup answers in part needs fewer.
    const float own =
        std::min({wanted * lobe.share / raysForOne, kRaysPerAlpha * lobe.alpha, kMostOwn * wanted});
    return int(std::bit_ceil(uint32_t(std::max(std::ceil(own), 1.0f))));
}

// Where a surface is seen.
struct Sight {
    glm::vec3 way{0};  // from the eye, world
    glm::vec2 barycentric{0};
};

// What all lobes of a kind, base or coat, see: those whose share is not 0. Each step is called for all, [0,
// count()), before the next.
class LobeTracer {
  public:
    LobeTracer(const ReflectionScene& scene, const ReflectionView& view,
               std::span<const TracedSurface> surfaces, std::span<const Sight> sights,
               TracedLobe TracedSurface::*lobe, uint64_t kind)
        : scene_(scene),
          view_(view),
          surfaces_(surfaces),
          sights_(sights),
          lobe_(lobe),
          kind_(kind),
          wanted_(wantedOf(surfaces, lobe)),
          pool_(places(), view.width, view.height),
          lights_(wanted_.size()),
          shares_(wanted_.size()) {}

    size_t count() const { return wanted_.size(); }
    uint32_t surfaceOf(size_t i) const { return wanted_[i]; }

    void trace(size_t i, uint64_t& rayCount) {
        const TracedSurface& s = surfaces_[wanted_[i]];
        const Sight& sight = sights_[wanted_[i]];
        const TracedLobe& lobe = s.*lobe_;
        LobeRays rays{scene_, view_, rayCount,
                      surfaceAt(scene_.rays.scene(), s.triangle, sight.barycentric, s.back)};
        rays.point.shading = frameFromNormal(lobe.normal);
        rays.point.brdf = Brdf{};
        rays.point.brdf.f0 = glm::vec3(lobe.f0);
        rays.point.brdf.f90 = lobe.f90;
        rays.point.brdf.alpha = lobe.alpha;
        rays.eyeLocal = rays.point.shading.toLocal(-sight.way);
        rays.albedo = specularAlbedo(rays.point.brdf.f0, lobe.f90, lobe.alpha, rays.eyeLocal.z).x;
        if (rays.albedo <= 0.0f) return;
        const float raysForOne = pool_.raysForOne(i);
        const int count = rayCountFor(lobe, raysForOne, view_.pictures);
        const int walks = std::max(int(kWalks / (raysForOne * float(count))), 1);
        const uint64_t stream = hashOf(kStream, s.pixel) + kind_;
        lights_[i] = rays.trace(count, walks, numbersFor(s.pixel, stream, count, raysForOne), stream);
    }

    void shareOut(size_t i) { shares_[i] = pool_.shareOut(i, lights_); }

    SeenByLobe seen(size_t i) const {
        const PooledLight light = pool_.pooled(i, lights_, shares_);
        return {light.indirect, light.area,
                light.weight > 0.0f ? (surfaces_[wanted_[i]].*lobe_).share : 0.0f};
    }

  private:
    static std::vector<uint32_t> wantedOf(std::span<const TracedSurface> surfaces,
                                          TracedLobe TracedSurface::*lobe) {
        std::vector<uint32_t> wanted;
        for (uint32_t i = 0; i < surfaces.size(); ++i)
            if ((surfaces[i].*lobe).share > 0) wanted.push_back(i);
        return wanted;
    }

    // Where neighbours count, 4x4 pixels share a sequence, in other parts from picture to picture: their rays
    // are stratified together.
    RayNumbers numbersFor(uint32_t pixel, uint64_t stream, int count, float raysForOne) const {
        const uint32_t first = view_.frame * uint32_t(count);
        if (raysForOne < kSharedFrom) return {uint32_t(stream), first, 1};
        const uint32_t x = pixel % uint32_t(view_.width), y = pixel / uint32_t(view_.width);
        const uint32_t rank = (4 * (y & 3) + (x & 3)) ^ (view_.frame & 15);
        return {uint32_t(hashOf(kStream, kind_)), 16 * first + rank, 16};
    }

    std::vector<PooledLobe> places() const {
        const Scene& scene = scene_.rays.scene();
        std::vector<PooledLobe> places;
        for (const uint32_t i : wanted_) {
            const TracedSurface& s = surfaces_[i];
            const TracedLobe& lobe = s.*lobe_;
            places.push_back({s.pixel, 2 * scene.triangleSurface[s.triangle] + uint32_t(s.back),
                              positionAt(scene, s.triangle, sights_[i].barycentric),
                              glm::reflect(sights_[i].way, lobe.normal), lobe.alpha,
                              std::max(lobe.distance, 1e-3f)});
        }
        return places;
    }

    const ReflectionScene& scene_;
    const ReflectionView& view_;
    const std::span<const TracedSurface> surfaces_;
    const std::span<const Sight> sights_;
    TracedLobe TracedSurface::*const lobe_;
    const uint64_t kind_;
    const std::vector<uint32_t> wanted_;  // of the surfaces
    const ReflectionPool pool_;
    std::vector<PooledLight> lights_;
    std::vector<ReflectionPool::Share> shares_;
};

}  // namespace

std::vector<SeenBySurface> traceReflections(const ReflectionScene& scene, const ReflectionView& view,
                                            std::span<const TracedSurface> surfaces, Progress& progress,
                                            uint64_t& rayCount) {
    constexpr size_t kGrain = 64;
    splitSumTable();  // integrated now, not by the first of the threads while the others wait
    std::vector<Sight> sights;
    for (const TracedSurface& s : surfaces) {
        const CameraRay eye = cameraRay(view.camera, view.width, view.height, s.place);
        sights.push_back({eye.direction, barycentricOn(scene.rays.scene(), s.triangle, eye)});
    }
    LobeTracer base(scene, view, surfaces, sights, &TracedSurface::base, 0);
    LobeTracer coat(scene, view, surfaces, sights, &TracedSurface::coat, 1);

    std::vector<SeenBySurface> seen(surfaces.size());
    std::atomic<uint64_t> rays{0};
    const ProgressStage stage(progress, "reflections", base.count() + coat.count());
    const auto trace = [&](LobeTracer& lobes, SeenByLobe SeenBySurface::*lobe) {
        parallelRanges(lobes.count(), kGrain, progress, [&](size_t begin, size_t end) {
            uint64_t rangeRays = 0;
            for (size_t i = begin; i < end; ++i) lobes.trace(i, rangeRays);
            rays += rangeRays;
        });
        SilentProgress silent;
        parallelRanges(lobes.count(), kGrain, silent, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) lobes.shareOut(i);
        });
        parallelRanges(lobes.count(), kGrain, silent, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) seen[lobes.surfaceOf(i)].*lobe = lobes.seen(i);
        });
    };
    trace(base, &SeenBySurface::base);
    trace(coat, &SeenBySurface::coat);
    rayCount += rays;
    return seen;
}

}  // namespace phat
