#pragma once
// One vertex of a path: common to all that trace paths.

#include "core/base/random.h"
#include "core/scene/lit_scene.h"
#include "core/scene/shading.h"
#include "core/transport/path_guide.h"

namespace phat {

/// Where a ray along `direction` starts.
glm::vec3 originOn(const RayScene& rays, const SurfacePoint& point, glm::vec3 direction);

/// Of light that was sampled for `position`, the part that arrives at `origin`, which is `position` moved off
/// its surface: 0 in shadow, 1 in the open, between them behind glass (seeStraight). Geometry that touches
/// the emitter occludes it only where it is strictly in front of the sampled point: a lamp's housing occludes
/// its rim from behind. Adds its rays to `rayCount`.
glm::vec3 transmittanceToLight(const RayScene& rays, glm::vec3 position, glm::vec3 origin,
                               const LightSample& light, uint64_t& rayCount);

/// A direction that the shading normal allows may still point into the flat triangle: light does not pass.
bool leavesSurface(const SurfacePoint& point, glm::vec3 direction);

/// A surface point on one side of the surface.
struct PathVertex {
    const SurfacePoint& point;
    ViewedBrdf brdf;  // in the point's shading frame

    const PathGuide::Density* guide = nullptr;  // for a fraction of the Lambert samples

    PathVertex(const SurfacePoint& of, glm::vec3 towardEye)
        : point(of), brdf(viewedBrdf(of.brdf, of.shading.toLocal(towardEye))) {}
};

/// sampleBrdf, but a fraction of the Lambert lobe's samples is drawn from the guide.
BrdfSample sampleDirection(const PathVertex& vertex, float lobe, glm::vec2 square);
/// Its density, 1/sr.
float sampleDirectionPdf(const PathVertex& vertex, glm::vec3 local);

/// Radiance that the vertex reflects of the punctual lights, by shadow rays: to each of a few, or to one of
/// many that is sampled by its unoccluded contribution. `numbers` in [0, 1): the light, the point on it.
glm::vec3 punctualLight(const LitScene& scene, const PathVertex& vertex, glm::vec3 numbers,
                        uint64_t& rayCount);
inline glm::vec3 punctualLight(const LitScene& scene, const SurfacePoint& point, glm::vec3 towardEye,
                               Rng& rng, uint64_t& rayCount) {
    const float choice = rng.uniform();
    const glm::vec2 onDisc = scene.lights.hasDiscs() ? rng.uniform2() : glm::vec2(0);
    return punctualLight(scene, PathVertex(point, towardEye), {choice, onDisc}, rayCount);
}

/// The same of one point on the area lights, weighted against sampleDirection by the balance heuristic (Veach
/// 1997). `numbers`: the light, the point on it.
glm::vec3 areaLight(const LitScene& scene, const PathVertex& vertex, glm::vec3 numbers, uint64_t& rayCount);
inline glm::vec3 areaLight(const LitScene& scene, const SurfacePoint& point, glm::vec3 towardEye, Rng& rng,
                           uint64_t& rayCount) {
    const float choice = rng.uniform();
    const glm::vec2 square = rng.uniform2();
    return areaLight(scene, PathVertex(point, towardEye), {choice, square}, rayCount);
}

/// Density with which areaLight samples a ray's hit, 1/sr.
float areaPdf(const LightSampler& lights, glm::vec3 from, const Hit& hit, glm::vec3 direction);

/// Russian roulette: the chance of going on after reflection number `bounce`, counted from 0.
float survivalChance(int bounce, glm::vec3 throughput);

}  // namespace phat
