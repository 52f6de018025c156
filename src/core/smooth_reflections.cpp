#include "core/smooth_reflections.h"

#include <atomic>

#include "core/brdf.h"
#include "core/parallel.h"
#include "core/path_vertex.h"
#include "core/sobol.h"

namespace phat {
namespace {

// Roughness up to which rays alone answer, and from which on the lookup alone does.
constexpr float kAllTraced = 0.12f, kNoneTraced = 0.2f;
// Rays a pixel and picture: one for a mirror, more as the lobe's width in radians, some 2 alpha, grows.
constexpr float kRaysPerAlpha = 200.0f;
constexpr int kMostRays = 16;
// Where rays hit something glossy, walks go on from there: so many a pixel and picture, shared by its rays,
// and of so many reflections at most.
constexpr int kWalks = 8, kMostBounces = 8;
constexpr uint64_t kStream = 0x5e1f;  // of hashOf

float smoothstep(float low, float high, float x) {
    const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

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

/// A lobe as a surface of its own.
struct LobeRays {
    const ReflectionScene& scene;
    const ReflectionView& view;
    uint64_t& rayCount;
    SurfacePoint point;
    glm::vec3 eyeLocal{0};
    float albedo = 0;

    glm::vec3 seenByLightSample(Rng& rng) const;
    SeenByLobe trace(int count, uint64_t stream) const;
};

// Power heuristic (Veach 1997): most light samples of a sharp lobe are rare finds of what its own rays find
// surely, and should weigh nothing rather than one.
// pre: own > 0.
float powerWeight(float own, float other) {
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

SeenByLobe LobeRays::trace(int count, uint64_t stream) const {
    const TexelWorld world{scene.rays, scene.lights, scene.atlas, scene.texels};
    const TexelIrradiance irradiance{scene.phatexture.indirectIrradiance, scene.phatexture.areaIrradiance,
                                     true};
    const PathSettings atHits{std::max(kWalks / count, 1), kMostBounces};
    SeenByLobe seen;
    float weights = 0;
    glm::vec3 sampled(0);
    for (int i = 0; i < count; ++i) {
        const uint32_t index = view.frame * uint32_t(count) + uint32_t(i);
        Rng rng(hashOf(stream, index));
        if (view.area && scene.lights.hasArea()) sampled += seenByLightSample(rng);
        const BrdfSample sample =
            sampleBrdf(point.brdf, eyeLocal, 0.5f, glm::vec2(sobol4(index, uint32_t(stream))));
        if (sample.pdf <= 0.0f) continue;
        const glm::vec3 direction = glm::normalize(point.shading.toWorld(sample.direction));
        if (!leavesSurface(point, direction)) continue;
        const float weight = sample.weight.x;
        weights += weight;

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
            seen.indirect +=
                weight * reflectedFromTexels(world, irradiance, hit, far, -direction, atHits, rng, rayCount);
    }
    if (weights <= 0.0f) return {};
    seen.indirect /= weights;
    seen.area = seen.area / weights + sampled / float(count);
    // A clamp: the two are independent estimates, whose noise must not exceed all light that there is.
    const glm::vec3 scale =
        glm::min(glm::vec3(1), scene.brightest / glm::max(seen.indirect + seen.area, glm::vec3(1e-20f)));
    seen.indirect *= scale;
    seen.area *= scale;
    seen.share = 1;
    return seen;
}

SeenByLobe seenBy(const ReflectionScene& scene, const ReflectionView& view, Reflections reflections,
                  const SurfacePoint& surface, glm::vec3 towardEye, const SmoothLobe& lobe, uint64_t stream,
                  uint64_t& rayCount) {
    const float share = tracedShare(reflections, lobe.alpha);
    if (share <= 0.0f) return {};
    LobeRays rays{scene, view, rayCount, surface};
    rays.point.shading = frameFromNormal(lobe.normal);
    rays.point.brdf = Brdf{};
    rays.point.brdf.f0 = glm::vec3(lobe.f0);
    rays.point.brdf.f90 = lobe.f90;
    rays.point.brdf.alpha = lobe.alpha;
    rays.eyeLocal = rays.point.shading.toLocal(towardEye);
    rays.albedo = specularAlbedo(rays.point.brdf.f0, lobe.f90, lobe.alpha, rays.eyeLocal.z).x;
    if (rays.albedo <= 0.0f) return {};
    const int count = std::clamp(int(std::ceil(kRaysPerAlpha * lobe.alpha)), 1, kMostRays);
    SeenByLobe seen = rays.trace(count, stream);
    seen.share *= share;
    return seen;
}

}  // namespace

float tracedShare(Reflections reflections, float alpha) {
    if (alpha <= 0.0f || reflections == Reflections::lookup) return 0.0f;
    if (reflections == Reflections::rays) return 1.0f;
    return 1.0f - smoothstep(kAllTraced, kNoneTraced, std::sqrt(alpha));
}

bool mayReflectSmoothly(std::span<const Material> materials, Reflections reflections) {
    const auto may = [&](float roughness, const TextureSlot& slot) {
        return tracedShare(reflections,
                           slot.image >= 0 ? kMinAlpha : std::max(square(roughness), kMinAlpha)) > 0;
    };
    return std::any_of(materials.begin(), materials.end(), [&](const Material& m) {
        if (m.unlit || m.alphaMode == AlphaMode::blend) return false;
        return may(m.roughness, m.metallicRoughnessTexture) ||
               (m.clearcoat > 0 && may(m.clearcoatRoughness, m.clearcoatRoughnessTexture));
    });
}

std::vector<SeenBySurface> traceReflections(const ReflectionScene& scene, const ReflectionView& view,
                                            Reflections reflections, std::span<const SmoothSurface> surfaces,
                                            Progress& progress, uint64_t& rayCount) {
    constexpr size_t kGrain = 64;
    splitSumTable();  // integrated now, not by the first of the threads while the others wait
    std::vector<SeenBySurface> seen(surfaces.size());
    std::atomic<uint64_t> rays{0};
    const ProgressStage stage(progress, "reflections", surfaces.size());
    parallelRanges(surfaces.size(), kGrain, progress, [&](size_t begin, size_t end) {
        uint64_t rangeRays = 0;
        for (size_t i = begin; i < end; ++i) {
            const SmoothSurface& s = surfaces[i];
            const CameraRay ray = cameraRay(view.camera, view.width, view.height, s.place);
            const SurfacePoint point = surfaceAt(scene.rays.scene(), s.triangle,
                                                 barycentricOn(scene.rays.scene(), s.triangle, ray), s.back);
            const uint64_t stream = hashOf(kStream, s.pixel);
            seen[i].base = seenBy(scene, view, reflections, point, -ray.direction, s.base, stream, rangeRays);
            seen[i].coat =
                seenBy(scene, view, reflections, point, -ray.direction, s.coat, stream + 1, rangeRays);
        }
        rays += rangeRays;
    });
    rayCount += rays;
    return seen;
}

}  // namespace phat
