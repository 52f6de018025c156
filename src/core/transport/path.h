#pragma once
// Path tracing: the radiance that a PHATexel's ray brings back, and irradiance of area lights.

#include "core/base/random.h"
#include "core/scene/lit_scene.h"
#include "core/transport/path_guide.h"
#include "core/transport/path_numbers.h"

namespace phat {

/// Incident radiance along one direction.
struct IncidentRadiance {
    glm::vec3 emitted{0};    // straight from an emissive surface or the environment
    glm::vec3 reflected{0};  // everything that was reflected at least once
    float distance = kFarDistance;
    uint64_t rays = 0;
};

struct PathSettings {
    int pathsPerHit = 4;  // continuations of the one ray, stratified together
    int maxBounces = 12;  // reflections between the light and the receiver
};

/// Traces one ray and, from what it meets, `pathsPerHit` paths: next-event estimation of every punctual light
/// (of one by its contribution, where there are more than four) and of one point on the area lights, multiple
/// importance sampling (balance heuristic, Veach 1997), Russian roulette by the root of the throughput from
/// the third bounce. Unbiased but for `maxBounces`.
IncidentRadiance traceIncident(const LitScene& scene, const Ray& ray, const PathSettings& settings, Rng rng);

/// Light that a surface reflects, in parts.
struct ReflectedRadiance {
    glm::vec3 direct{0};           // straight from the lights
    glm::vec3 indirectDiffuse{0};  // the rest, by the lobe of this surface that reflects it
    glm::vec3 indirectGlossy{0};   // GGX and the coat

    glm::vec3 sum() const { return direct + indirectDiffuse + indirectGlossy; }
};

/// The components of a path's first reflection that are computed; the others cost no rays and add no noise.
struct FirstReflection {
    bool direct = true;  // false: ReflectedRadiance::direct is not complete
    Lobes lobes = Lobes::all;
};

/// The surface whose reflection a path estimates.
struct PathStart {
    const SurfacePoint& point;
    glm::vec3 towardEye;  // world
    FirstReflection first = {};
    /// Directions of most of what diffuse surfaces reflect; null: by the cosine.
    const PathGuide* guide = nullptr;
};

/// One path of at most `maxBounces` reflections.
ReflectedRadiance tracePath(const LitScene& scene, const PathStart& start, int maxBounces,
                            PathNumbers& numbers, uint64_t& rayCount);

/// The sum of one with independent numbers.
glm::vec3 traceReflected(const LitScene& scene, const PathStart& start, int maxBounces, Rng& rng,
                         uint64_t& rayCount);

/// A Monte Carlo estimate of irradiance.
struct IrradianceEstimate {
    glm::vec3 value{0};           // W/m2
    float variance = 0;           // of the value's luminance
    bool partlyShadowed = false;  // some light samples were in shadow and some were not
};

struct IrradianceSampling {
    int lightSamplesPerRound = 8;
    int rounds = 2;
};

/// Irradiance of emissive surfaces and the environment at a position: light samples and half as many
/// cosine-weighted rays, combined by the balance heuristic (Veach 1997), in independent rounds whose spread
/// gives the variance. pre: sampling.rounds >= 2.
IrradianceEstimate areaIrradiance(const LitScene& scene, glm::vec3 position, glm::vec3 normal,
                                  const IrradianceSampling& sampling, Rng rng, uint64_t& rayCount);

}  // namespace phat
