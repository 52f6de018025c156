#include "core/probes/probe_gather.h"

#include "core/base/sobol.h"
#include "core/scene/glass.h"
#include "core/transport/path_vertex.h"

namespace phat {
namespace {

// Rays over the sphere, and samples of the area lights.
constexpr uint32_t kSphereRays = 512, kLightSamples = 256;
constexpr float kSpherePdf = 1.0f / (4.0f * kPi);  // 1/sr

constexpr PathSettings kPaths{.pathsPerHit = 1};

// source: Archimedes; areas of the square stay in proportion.
glm::vec3 squareToSphere(glm::vec2 square) {
    const float z = 1.0f - 2.0f * square.x;
    const float radius = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const float angle = 2.0f * kPi * square.y;
    return {radius * std::cos(angle), radius * std::sin(angle), z};
}

// The weight of one of two techniques' samples by the balance heuristic (Veach 1997), over the density.
float balance(float spherePdf, float lightPdf, bool lights) {
    return 1.0f / (float(kSphereRays) * spherePdf + (lights ? float(kLightSamples) * lightPdf : 0.0f));
}

// Distance to the first opaque surface straight ahead; kFarDistance: none.
float opaqueDistance(const RayScene& rays, const Ray& ray, uint64_t& rayCount) {
    ++rayCount;
    const StraightView view = seeStraight(rays, ray, kFarDistance, rayCount);
    return view.hit ? view.hit.distance : kFarDistance;
}

struct Nearest {
    float distance = kFarDistance;
    glm::vec3 direction{0};
};

// Fills the probe's distances from where it is.
Nearest findDistances(const RayScene& rays, ProbeRays& probe, uint64_t& rayCount) {
    Nearest nearest;
    for (int i = 0; i < kDistanceNodes * kDistanceNodes; ++i) {
        const glm::vec3 node = distanceNode(i);
        const float length = glm::length(node);
        const glm::vec3 direction = node / length;
        const float distance = opaqueDistance(rays, {probe.position, direction}, rayCount);
        if (distance < nearest.distance) nearest = {distance, direction};
        // The hit is at distance / length in the octahedron's norm.
        probe.reciprocalDistance[size_t(i)] = distance < kFarDistance ? length / distance : 0.0f;
    }
    return nearest;
}

void addSphereRays(const ProbeWorld& world, uint64_t seed, ProbeRays& probe, uint64_t& rayCount) {
    const LitScene& scene = world.texels.scene;
    const bool lights = scene.lights.hasArea();
    Rng rng(hashOf(seed, 1));
    for (uint32_t i = 0; i < kSphereRays; ++i) {
        const glm::vec3 direction = squareToSphere(glm::vec2(shuffledSobol4(i, seed)));
        ++rayCount;
        const SeenThrough seen =
            seeThrough(scene.rays, {probe.position, direction}, hashOf(seed, 2, i), rayCount);
        const glm::vec3 arriving = seen.ray.direction;
        glm::vec3 emitted = scene.lights.environmentRadiance(arriving);
        if (seen.hit) {
            const SurfacePoint point = surfaceAt(scene.rays.scene(), seen.hit, arriving);
            emitted = point.emission;
            const HitReflection reflected = reflectedFromTexels(
                world.texels, world.irradiance, {seen.hit, point, -arriving}, kPaths, rng, rayCount);
            probe.indirect.addLight(direction,
                                    seen.throughput * reflected.sum() * balance(kSpherePdf, 0, false));
        }
        if (maxComponent(emitted) <= 0.0f) continue;
        const float lightPdf = areaPdf(scene.lights, seen.ray.origin, seen.hit, arriving);
        probe.area.addLight(direction, seen.throughput * emitted * balance(kSpherePdf, lightPdf, lights));
    }
}

void addLightSamples(const ProbeWorld& world, uint64_t seed, ProbeRays& probe, uint64_t& rayCount) {
    const LitScene& scene = world.texels.scene;
    if (!scene.lights.hasArea()) return;
    for (uint32_t i = 0; i < kLightSamples; ++i) {
        const glm::vec3 numbers(shuffledSobol4(i, seed));
        const LightSample light = scene.lights.sampleArea(probe.position, numbers.x, {numbers.y, numbers.z});
        if (light.pdf <= 0.0f || maxComponent(light.radiance) <= 0.0f) continue;
        const glm::vec3 transmittance =
            transmittanceToLight(scene.rays, probe.position, probe.position, light, rayCount);
        probe.area.addLight(light.towardLight,
                            transmittance * light.radiance * balance(kSpherePdf, light.pdf, true));
    }
}

}  // namespace

ProbeRays gatherProbe(const ProbeWorld& world, glm::vec3 corner, float clearance, uint64_t index,
                      uint64_t& rayCount) {
    const RayScene& rays = world.texels.scene.rays;
    ProbeRays probe;
    probe.position = corner;
    const Nearest nearest = findDistances(rays, probe, rayCount);
    if (nearest.distance < clearance) {
        const float free = opaqueDistance(rays, {corner, -nearest.direction}, rayCount);
        probe.position -= std::min(clearance - nearest.distance, 0.5f * free) * nearest.direction;
        findDistances(rays, probe, rayCount);
    }
    const uint64_t seed = hashOf(world.seed + 0x9be, index);
    addSphereRays(world, seed, probe, rayCount);
    addLightSamples(world, hashOf(seed, 3), probe, rayCount);
    return probe;
}

}  // namespace phat
