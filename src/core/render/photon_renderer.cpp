#include "core/render/photon_renderer.h"

#include "core/phatexel/directions.h"
#include "core/render/visible_lobe.h"
#include "core/transport/path.h"

namespace phat {
namespace {

/// Light that was reflected at least once before it meets `point`, whose BRDF is the component's alone.
using IndirectLight = glm::vec3 (*)(const PhotonScene& scene, const PhotonRendererSettings& settings,
                                    const SurfacePoint& point, glm::vec3 towardEye, PixelSample& sample);

// Direct light of the point, with shadow rays: a path of one reflection.
glm::vec3 directLight(const PhotonScene& scene, const SurfacePoint& point, glm::vec3 towardEye,
                      PixelSample& sample) {
    return traceReflected({scene.rays, scene.lights}, {point, towardEye}, 1, sample.rng, sample.rays);
}

glm::vec3 indirectByPhotons(const PhotonScene& scene, const PhotonRendererSettings& settings,
                            const SurfacePoint& point, glm::vec3 towardEye, PixelSample&) {
    return photonRadiance({scene.photons, scene.index}, point, towardEye, settings.density, isIndirectPhoton);
}

// Incident radiance along a gather ray. Emission is left out: it is direct light of the visible point.
glm::vec3 gatheredLight(const PhotonScene& scene, const PhotonRendererSettings& settings,
                        const SurfacePoint& from, glm::vec3 direction, PixelSample& sample) {
    const glm::vec3 origin = scene.rays.offsetOrigin(from.position, from.normalGeometric);
    ++sample.rays;
    const SeenThrough seen = seeThrough(scene.rays, {origin, direction}, 0, sample.rays);
    if (!seen.hit) return glm::vec3(0);
    const glm::vec3 arriving = seen.ray.direction;
    const SurfacePoint point = surfaceAt(scene.rays.scene(), seen.hit, arriving);
    if (!reflects(point.brdf)) return glm::vec3(0);
    return seen.throughput * (directLight(scene, point, -arriving, sample) +
                              indirectByPhotons(scene, settings, point, -arriving, sample));
}

glm::vec3 indirectByGathering(const PhotonScene& scene, const PhotonRendererSettings& settings,
                              const SurfacePoint& point, glm::vec3 towardEye, PixelSample& sample) {
    // Golden-ratio (R2) points with a random shift: every run of them is stratified, so each lobe, which
    // takes a run, gets its own stratified set (Roberts 2018).
    constexpr glm::vec2 kR2(0.7548776662f, 0.5698402910f);
    const glm::vec3 eyeLocal = point.shading.toLocal(towardEye);
    const float lobeShift = sample.rng.uniform();
    const glm::vec2 squareShift = sample.rng.uniform2();
    glm::vec3 sum(0);
    for (int i = 0; i < settings.gatherRays; ++i) {
        // Rounding could carry the last one to 1.
        const float lobe = std::min((float(i) + lobeShift) / float(settings.gatherRays), 0x1.fffffep-1f);
        const glm::vec2 square = glm::fract(squareShift + float(i) * kR2);
        const BrdfSample drawn = sampleBrdf(point.brdf, eyeLocal, lobe, square);
        if (drawn.pdf <= 0.0f) continue;
        const glm::vec3 direction = glm::normalize(point.shading.toWorld(drawn.direction));
        if (glm::dot(direction, point.normalGeometric) <= 0.0f) continue;
        sum += drawn.weight * gatheredLight(scene, settings, point, direction, sample);
    }
    return sum / float(settings.gatherRays);
}

Integrator photonRenderer(const PhotonScene& scene, const PhotonRendererSettings& settings,
                          IndirectLight indirectLight) {
    const Scene& viewedScene = scene.viewedScene ? *scene.viewedScene : scene.rays.scene();
    return [=, viewed = RayScene(viewedScene, scene.rays.bvh())](const Ray& ray, PixelSample& sample) {
        const bool direct = showsDirect(settings.component);
        const SeenThrough seen = visibleThrough(viewed, ray, sample);
        const glm::vec3 direction = seen.ray.direction;
        if (!seen.hit)
            return direct ? seen.throughput * scene.lights.environmentRadiance(direction) : glm::vec3(0);
        SurfacePoint point = surfaceAt(viewed.scene(), seen.hit, direction);
        glm::vec3 radiance(0);
        if (direct) radiance += point.emission + directLight(scene, point, -direction, sample);
        point.brdf = indirectLobes(point.brdf, point.shading.toLocal(-direction), settings.component);
        if (reflects(point.brdf)) radiance += indirectLight(scene, settings, point, -direction, sample);
        return seen.throughput * radiance;
    };
}

}  // namespace

Integrator photonsDirect(const PhotonScene& scene, const PhotonRendererSettings& settings) {
    return photonRenderer(scene, settings, indirectByPhotons);
}

Integrator photonsGather(const PhotonScene& scene, const PhotonRendererSettings& settings) {
    return photonRenderer(scene, settings, indirectByGathering);
}

}  // namespace phat
