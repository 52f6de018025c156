#include "core/bake/irradiance_ray.h"

#include <algorithm>
#include <cmath>

#include "core/atlas/atlas_position.h"
#include "core/atlas/texel_neighbors.h"
#include "core/base/sobol.h"
#include "core/scene/glass.h"
#include "core/transport/path.h"
#include "core/transport/path_vertex.h"

namespace phat {
namespace {

// Walks that a lossless mirror gets for each path that is asked for: measured, see notes/experiments.md.
constexpr float kWalksPerPath = 3.0f;
// A walk between lossless mirrors would not end before the longest path does.
constexpr int kMaxWalkBounces = 12;
// Factor by which near hits have more walks.
constexpr float kMaxNearFactor = 8.0f;

// Light that reaches a rough surface by way of a sharp one (a caustic) is found by rare walks alone, each of
// which is a firefly. So a surface that a walk meets is taken at least so rough as this part of the lobe that
// led there, and samples of the lights find what it reflects: a bias, a blur of what is seen in two
// reflections. source: Kaplanyan and Dachsbacher 2013, "Path Space Regularization".
constexpr float kRegularized = 0.5f;

// The fraction of diffuse irradiance over pi that is reflected toward the eye.
glm::vec3 diffuseAlbedo(const Brdf& brdf, glm::vec3 towardEyeLocal) {
    return clearcoatTransmission(brdf, towardEyeLocal) * diffuseWeight(brdf, towardEyeLocal.z) *
           brdf.diffuseColor;
}

TexelWorld texelWorldOf(const GatherInput& input) {
    return {input.scene(), input.atlas, input.points, input.irradianceTexels};
}

SurfacePoint withoutDiffuse(SurfacePoint point) {
    point.brdf.diffuseColor = glm::vec3(0);
    return point;
}

SurfacePoint regularized(SurfacePoint point, const Brdf& before) {
    const bool coated = before.clearcoat > 0.0f;
    const float atLeast =
        kRegularized * (coated ? std::min(before.alpha, before.clearcoatAlpha) : before.alpha);
    point.brdf.alpha = std::max(point.brdf.alpha, atLeast);
    point.brdf.clearcoatAlpha = std::max(point.brdf.clearcoatAlpha, atLeast);
    return point;
}

}  // namespace

std::optional<uint32_t> texelOfHit(const TexelWorld& world, const Hit& hit) {
    const Atlas& atlas = world.atlas;
    const AtlasPosition position = atlasPositionOf(atlas, hit);
    if (position.chart == kNoChart) return {};
    const glm::ivec2 center(position.texel), last = glm::ivec2(atlas.sizeTexels) - 1;
    const size_t own = size_t(center.y) * atlas.sizeTexels.x + size_t(center.x);
    const auto isOf = [&](size_t texel) {
        return texel == own || world.points.triangle[own] == kNoTriangle ||
               lieTogether(atlas, world.points, own, texel);
    };
    // At edges and contacts the texel's own centre may be off the surface or occluded. The middle first.
    constexpr int kOrder[9] = {4, 1, 3, 5, 7, 0, 2, 6, 8};
    for (const int i : kOrder) {
        const glm::ivec2 texel = center + glm::ivec2(i % 3 - 1, i / 3 - 1);
        if (glm::any(glm::lessThan(texel, glm::ivec2(0))) || glm::any(glm::greaterThan(texel, last)))
            continue;
        const size_t index = size_t(texel.y) * atlas.sizeTexels.x + texel.x;
        if (world.irradianceTexels[index] && atlas.chartAt(texel) == position.chart && isOf(index))
            return uint32_t(index);
    }
    return {};
}

namespace {

// The random numbers of one glossy reflection, in [0, 1).
struct StepNumbers {
    glm::vec4 reflection;  // the lobe, the direction in it, whether the walk survives
    glm::vec3 light;       // which area light, the point on it
};

StepNumbers stepNumbers(Rng& rng) {
    const glm::vec2 lobe = rng.uniform2(), rest = rng.uniform2(), onLight = rng.uniform2();
    return {{lobe, rest}, {onLight, rng.uniform()}};
}

// The same of walk `i` of those from one point, which are stratified together.
StepNumbers firstStepNumbers(uint32_t i, uint64_t seed) {
    i %= kMaxShuffled;
    return {shuffledSobol4(i, seed), glm::vec3(shuffledSobol4(i, seed + 3 * kSeedStep))};
}

/// A walk through mirrors and gloss until it ends in a texel. Each step returns whether it goes on.
struct Walk {
    const TexelWorld& world;
    const std::vector<uint32_t>& areaIrradiance;
    Rng& rng;
    uint64_t& rayCount;
    Hit hit;
    SurfacePoint point;  // at `hit`, with the lobes that reflect
    glm::vec3 towardEye;
    glm::vec3 throughput{1};
    IrradianceRay found{};
    float stepMeters = kFarDistance;  // of the last step

    glm::vec3 eyeLocal() const { return point.shading.toLocal(towardEye); }
    bool ends();
    bool reflects(int bounce, const StepNumbers& numbers);
};

// The diffuse part stops here, or the specular part goes on; where there is no texel, both do.
bool Walk::ends() {
    if (maxComponent(reflectance(point.brdf, eyeLocal())) <= 0.0f) return true;
    found.light += throughput * punctualLight(world.scene, point, towardEye, rng, rayCount);
    const std::optional<uint32_t> texel = texelOfHit(world, hit);
    if (!texel) return false;
    const glm::vec3 diffuse = diffuseAlbedo(point.brdf, eyeLocal());
    if (!areaIrradiance.empty())
        found.light += throughput * diffuse / kPi * unpackRgb9e5(areaIrradiance[*texel]);

    point = withoutDiffuse(point);
    const float specular = maxComponent(reflectance(point.brdf, eyeLocal()));
    const float follow = specular / (specular + maxComponent(diffuse));
    if (rng.uniform() >= follow) {
        found.texel = *texel;
        found.weight = throughput * diffuse / (kPi * (1.0f - follow));
        return true;
    }
    throughput /= follow;
    return false;
}

bool Walk::reflects(int bounce, const StepNumbers& numbers) {
    if (world.scene.lights.hasArea())
        found.light +=
            throughput * areaLight(world.scene, PathVertex(point, towardEye), numbers.light, rayCount);
    const glm::vec4 u = numbers.reflection;
    const BrdfSample sample = sampleBrdf(point.brdf, eyeLocal(), u.x, {u.y, u.z});
    if (sample.pdf <= 0.0f) return false;
    const glm::vec3 direction = glm::normalize(point.shading.toWorld(sample.direction));
    if (!leavesSurface(point, direction)) return false;
    throughput *= sample.weight;
    const float survival = survivalChance(bounce, throughput);
    if (survival < 1.0f && u.w >= survival) return false;
    throughput /= survival;

    ++rayCount;
    const SeenThrough seen =
        seeThrough(world.scene.rays, {originOn(world.scene.rays, point, direction), direction}, 0, rayCount);
    const glm::vec3 arriving = seen.ray.direction;
    hit = seen.hit;
    stepMeters = hit ? hit.distance : kFarDistance;
    throughput *= seen.throughput;
    const float weight =
        sample.pdf / (sample.pdf + areaPdf(world.scene.lights, point.position, hit, arriving));
    if (!hit) {
        found.light += throughput * weight * world.scene.lights.environmentRadiance(arriving);
        return false;
    }
    point = regularized(surfaceAt(world.scene.rays.scene(), hit, arriving), point.brdf);
    found.light += throughput * weight * point.emission;
    towardEye = -arriving;
    return true;
}

}  // namespace

IrradianceRay traceToTexels(const GatherInput& input, const std::vector<uint32_t>& areaIrradiance,
                            const Ray& ray, int maxBounces, Rng& rng, uint64_t& rayCount) {
    ++rayCount;
    const SeenThrough seen = seeThrough(input.rays, ray, 0, rayCount);
    if (!seen.hit) return {};
    const TexelWorld world = texelWorldOf(input);
    const glm::vec3 arriving = seen.ray.direction;
    const SurfacePoint point = surfaceAt(input.rays.scene(), seen.hit, arriving);
    Walk walk{world, areaIrradiance, rng, rayCount, seen.hit, point, -arriving, seen.throughput};
    walk.found.distance = seen.hit.distance;
    for (int bounce = 0; bounce < std::min(maxBounces, kMaxWalkBounces); ++bounce)
        if (walk.ends() || !walk.reflects(bounce, stepNumbers(rng))) break;
    return walk.found;
}

namespace {

/// The mean of some walks from one point: what they found, and of 1 / m to what they met first.
struct MeanOfWalks {
    glm::vec3 light{0};
    float nearness = 0;
};

// The walks begin with the lobes that `visible.point` has.
MeanOfWalks meanOfWalks(const TexelWorld& world, const TexelIrradiance& irradiance, const VisibleHit& visible,
                        const PathSettings& settings, Rng& rng, uint64_t& rayCount) {
    MeanOfWalks mean;
    const uint64_t seed = rng.bits64();
    for (int i = 0; i < settings.pathsPerHit; ++i) {
        Walk walk{world, irradiance.area, rng, rayCount, visible.hit, visible.point, visible.towardEye};
        for (int bounce = 0; bounce < std::min(settings.maxBounces, kMaxWalkBounces); ++bounce) {
            const bool goesOn =
                walk.reflects(bounce, bounce ? stepNumbers(rng) : firstStepNumbers(uint32_t(i), seed));
            if (bounce == 0) mean.nearness += 1.0f / walk.stepMeters;
            if (!goesOn || walk.ends()) break;
        }
        mean.light += walk.found.light;
        if (walk.found.texel != kNoTexel)
            mean.light += walk.found.weight * unpackRgb9e5(irradiance.indirect[walk.found.texel]);
    }
    mean.light /= float(settings.pathsPerHit);
    mean.nearness /= float(settings.pathsPerHit);
    return mean;
}

}  // namespace

HitReflection reflectedFromTexels(const TexelWorld& world, const TexelIrradiance& irradiance,
                                  const VisibleHit& visible, const PathSettings& settings, Rng& rng,
                                  uint64_t& rayCount) {
    const SurfacePoint& point = visible.point;
    const glm::vec3& towardEye = visible.towardEye;
    const glm::vec3 eyeLocal = point.shading.toLocal(towardEye);
    if (maxComponent(reflectance(point.brdf, eyeLocal)) <= 0.0f) return {};

    HitReflection reflected;
    reflected.rest = punctualLight(world.scene, point, towardEye, rng, rayCount);
    PathSettings walks = settings;
    walks.pathsPerHit = std::max(settings.pathsPerHit, 1);
    const std::optional<uint32_t> texel = texelOfHit(world, visible.hit);
    if (!texel) {
        reflected.rest += meanOfWalks(world, irradiance, visible, walks, rng, rayCount).light;
        return reflected;
    }
    const auto arriving = [&](const std::vector<uint32_t>& map) {
        if (map.empty()) return glm::vec3(0);
        if (!irradiance.interpolated) return unpackRgb9e5(map[*texel]);
        return bilinearAt(world.atlas, atlasPositionOf(world.atlas, visible.hit),
                          [&](size_t at) { return unpackRgb9e5(map[at]); });
    };
    reflected.rest += diffuseAlbedo(point.brdf, eyeLocal) / kPi *
                      (arriving(irradiance.indirect) + arriving(irradiance.area));
    const SurfacePoint glossy = withoutDiffuse(point);
    reflected.glossyAlbedo = reflectance(glossy.brdf, eyeLocal);
    const float albedo = maxComponent(reflected.glossyAlbedo);
    if (albedo <= 0.0f) return reflected;

    // The walks' noise counts by the albedo.
    walks.pathsPerHit = std::max(1, int(std::ceil(kWalksPerPath * albedo * float(walks.pathsPerHit))));
    const MeanOfWalks mean =
        meanOfWalks(world, irradiance, {visible.hit, glossy, towardEye}, walks, rng, rayCount);
    reflected.glossy = mean.light;
    reflected.nearness = mean.nearness;
    reflected.walks = walks.pathsPerHit;
    return reflected;
}

IncidentRadiance incidentFromTexels(const GatherInput& input, const TexelIrradiance& irradiance,
                                    const Ray& ray, const PathSettings& settings, float nearMeters, Rng rng) {
    IncidentRadiance incident;
    incident.rays = 1;
    const SeenThrough seen = seeThrough(input.rays, ray, 0, incident.rays);
    if (!seen.hit) return incident;
    incident.distance = seen.hit.distance;
    const TexelWorld world = texelWorldOf(input);
    PathSettings paths = settings;
    paths.pathsPerHit *= int(std::clamp(nearMeters / seen.hit.distance, 1.0f, kMaxNearFactor));
    const glm::vec3 arriving = seen.ray.direction;
    const SurfacePoint point = surfaceAt(input.rays.scene(), seen.hit, arriving);
    incident.reflected =
        seen.throughput *
        reflectedFromTexels(world, irradiance, {seen.hit, point, -arriving}, paths, rng, incident.rays).sum();
    return incident;
}

}  // namespace phat
