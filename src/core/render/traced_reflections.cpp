#include "core/render/traced_reflections.h"

#include <atomic>
#include <bit>
#include <cassert>

#include "core/base/parallel.h"
#include "core/base/sobol.h"
#include "core/render/reflection_pool.h"
#include "core/scene/brdf.h"
#include "core/scene/glass.h"
#include "core/transport/path_vertex.h"

namespace phat {
namespace {

// Rays for a neighbourhood in all frames together, and at least in each frame. A mirror needs one ray; the
// number grows with the lobe's width in radians, some 2 alpha. A pixel traces at most a fraction of them.
constexpr float kRaysPerNeighborhood = 64, kMinRaysPerFrame = 8;
constexpr float kRaysPerAlpha = 800;
constexpr float kMaxOwnFraction = 0.5f;
// Where at least so many pooled rays count for each traced one, 4x4 pixels share one sequence.
constexpr float kSharedFrom = 4;
// From glossy hits, walks continue: their number per neighbourhood and frame, and their greatest length.
constexpr float kWalks = 8;
constexpr int kMaxBounces = 8;
constexpr uint64_t kStream = 0x5e1f;  // of hashOf

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

    glm::vec3 estimateByLightSample(Rng& rng) const;
    PooledLight trace(int count, int walks, const RayNumbers& numbers, uint64_t stream) const;
};

// Power heuristic (Veach 1997): with the balance heuristic, the rare light samples that fall into a sharp
// lobe would count in full, although its BRDF samples find the same light reliably. pre: own > 0.
float powerWeight(float own, float other) {
    assert(own > 0.0f);
    return 1.0f / (1.0f + square(other / own));
}

// One light sample over the lobe's albedo: small emitters that BRDF samples rarely hit.
glm::vec3 LobeRays::estimateByLightSample(Rng& rng) const {
    const float choice = rng.uniform();
    const LightSample light = scene.lights.sampleArea(point.position, choice, rng.uniform2());
    if (light.pdf <= 0.0f || maxComponent(light.radiance) <= 0.0f || !leavesSurface(point, light.towardLight))
        return glm::vec3(0);
    const glm::vec3 local = point.shading.toLocal(light.towardLight);
    const float value = evaluateBrdf(point.brdf, eyeLocal, local).x;
    if (value <= 0.0f) return glm::vec3(0);
    const float weight = powerWeight(light.pdf, sampleBrdfPdf(point.brdf, eyeLocal, local));
    // Below this weight no emitter is bright enough to be visible, and the shadow ray is saved.
    constexpr float kMinWeight = 1e-6f;
    if (weight < kMinWeight) return glm::vec3(0);
    const glm::vec3 transmittance = transmittanceToLight(
        scene.rays, point.position, originOn(scene.rays, point, light.towardLight), light, rayCount);
    return transmittance * (value * weight / light.pdf / albedo * light.radiance);
}

PooledLight LobeRays::trace(int count, int walks, const RayNumbers& numbers, uint64_t stream) const {
    const TexelWorld world{{scene.rays, scene.lights}, scene.atlas, scene.points, scene.texels};
    const TexelIrradiance irradiance{scene.phatexture.indirectIrradiance, scene.phatexture.areaIrradiance,
                                     true};
    const PathSettings atHits{walks, kMaxBounces};
    PooledLight incident;
    glm::vec3 sampled(0);
    for (int i = 0; i < count; ++i) {
        Rng rng(hashOf(stream, view.frame, uint64_t(i)));
        if (view.area && scene.lights.hasArea()) sampled += estimateByLightSample(rng);
        const BrdfSample sample = sampleBrdf(point.brdf, eyeLocal, 0.5f, numbers.of(i));
        if (sample.pdf <= 0.0f) continue;
        const glm::vec3 direction = glm::normalize(point.shading.toWorld(sample.direction));
        if (!leavesSurface(point, direction)) continue;
        const float weight = sample.weight.x;
        incident.weight += weight;

        ++rayCount;
        const SeenThrough seen =
            seeThrough(scene.rays, {originOn(scene.rays, point, direction), direction}, stream, rayCount);
        const glm::vec3 arriving = seen.ray.direction;
        const float lightPdf = areaPdf(scene.lights, point.position, seen.hit, arriving);
        const glm::vec3 emissionWeight = weight * powerWeight(sample.pdf, lightPdf) * seen.throughput;
        if (!seen.hit) {
            incident.area += emissionWeight * scene.lights.environmentRadiance(arriving);
            continue;
        }
        const SurfacePoint far = surfaceAt(scene.rays.scene(), seen.hit, arriving);
        incident.area += emissionWeight * far.emission;
        if (view.indirect)
            incident.indirect +=
                weight * seen.throughput *
                reflectedFromTexels(world, irradiance, {seen.hit, far, -arriving}, atHits, rng, rayCount);
    }
    if (incident.weight <= 0.0f) return {};
    incident.indirect /= incident.weight;
    incident.area = incident.area / incident.weight + sampled / float(count);
    // A clamp: the two are independent estimates, whose noise must not exceed all light that there is.
    const glm::vec3 scale = glm::min(
        glm::vec3(1), scene.brightest / glm::max(incident.indirect + incident.area, glm::vec3(1e-20f)));
    incident.indirect *= scale;
    incident.area *= scale;
    return incident;
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

    PooledLight trace(size_t i, uint64_t& rayCount) const {
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
        const float raysForOne = pool_.raysForOne(i);
        const int count = rayCountFor(lobe, raysForOne, view_.pictures);
        const int walks = std::max(int(kWalks / (raysForOne * float(count))), 1);
        const uint64_t stream = hashOf(kStream, s.pixel) + kind_;
        return rays.trace(count, walks, numbersFor(s.pixel, stream, count, raysForOne), stream);
    }

    ReflectionPool::Redistribution redistribute(size_t i, const std::vector<PooledLight>& lights) const {
        return pool_.redistribute(i, lights);
    }

    LobeIncident incident(size_t i, const std::vector<PooledLight>& lights,
                          const std::vector<ReflectionPool::Redistribution>& redistributions) const {
        const PooledLight light = pool_.pooled(i, lights, redistributions);
        return {light.indirect, light.area,
                light.weight > 0.0f ? (surfaces_[traced_[i]].*lobe_).weight : 0.0f};
    }

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
                             glm::reflect(primaryRays_[i].direction, lobe.normal), lobe.alpha,
                             std::max(lobe.distance, 1e-3f * scene_.rays.unitMeters())});
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

}  // namespace

std::vector<SurfaceIncident> traceReflections(const ReflectionScene& scene, const ReflectionView& view,
                                              std::span<const TracedSurface> surfaces, Progress& progress,
                                              uint64_t& rayCount) {
    constexpr size_t kGrain = 64;
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
        std::vector<PooledLight> lights(lobes.count());
        std::vector<ReflectionPool::Redistribution> redistributions(lobes.count());
        parallelRanges(lobes.count(), kGrain, progress, [&](size_t begin, size_t end) {
            uint64_t rangeRays = 0;
            for (size_t i = begin; i < end; ++i) lights[i] = lobes.trace(i, rangeRays);
            rays += rangeRays;
        });
        SilentProgress silent;
        parallelRanges(lobes.count(), kGrain, silent, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) redistributions[i] = lobes.redistribute(i, lights);
        });
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
