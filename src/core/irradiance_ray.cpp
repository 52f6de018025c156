#include "core/irradiance_ray.h"

#include "core/path.h"
#include "core/path_vertex.h"

namespace phat {
namespace {

// The share of diffuse irradiance over pi that is reflected toward the eye.
glm::vec3 diffuseAlbedo(const Brdf& brdf, glm::vec3 towardEyeLocal) {
    return clearcoatTransmission(brdf, towardEyeLocal) * diffuseWeight(brdf, towardEyeLocal.z) *
           brdf.diffuseColor;
}

SurfacePoint withoutDiffuse(SurfacePoint point) {
    point.brdf.diffuseColor = glm::vec3(0);
    return point;
}

}  // namespace

std::optional<uint32_t> texelOfHit(const Atlas& atlas, const std::vector<uint8_t>& wanted, const Hit& hit) {
    uint32_t chart = atlas.triangleChart[hit.triangle];
    if (chart == kNoChart) return {};
    const auto& corner = atlas.triangleTexels[hit.triangle];
    glm::vec2 place =
        corner[0] + hit.barycentric.x * (corner[1] - corner[0]) + hit.barycentric.y * (corner[2] - corner[0]);
    if (atlas.charts[chart].back != hit.backFace) {
        const uint32_t other = atlas.charts[chart].otherSide;
        if (other == kNoChart) return {};
        place += glm::vec2(atlas.charts[other].originTexel()) - glm::vec2(atlas.charts[chart].originTexel());
        chart = other;
    }
    const glm::ivec2 center(place), last = glm::ivec2(atlas.sizeTexels) - 1;
    // At edges and contacts the texel's own centre may be off the surface or covered. The middle first.
    constexpr int kOrder[9] = {4, 1, 3, 5, 7, 0, 2, 6, 8};
    for (const int i : kOrder) {
        const glm::ivec2 texel = center + glm::ivec2(i % 3 - 1, i / 3 - 1);
        if (glm::any(glm::lessThan(texel, glm::ivec2(0))) || glm::any(glm::greaterThan(texel, last)))
            continue;
        const size_t index = size_t(texel.y) * atlas.sizeTexels.x + texel.x;
        if (wanted[index] && atlas.chartAt(texel) == chart) return uint32_t(index);
    }
    return {};
}

IrradianceRay traceToTexels(const GatherInput& input, const std::vector<uint32_t>& areaIrradiance,
                            glm::vec3 origin, glm::vec3 direction, int maxBounces, Rng& rng,
                            uint64_t& rayCount) {
    const RayScene& rays = input.rays;
    const LightSampler& lights = input.lights;
    IrradianceRay found;
    ++rayCount;
    Hit hit = rays.closestHit(origin, direction);
    if (!hit) return found;
    found.distance = hit.distance;
    SurfacePoint point = surfaceAt(rays.scene(), hit, direction);
    glm::vec3 towardEye = -direction, throughput(1);

    for (int bounce = 0; bounce < maxBounces; ++bounce) {
        const glm::vec3 towardEyeLocal = point.shading.toLocal(towardEye);
        if (maxComponent(reflectance(point.brdf, towardEyeLocal)) <= 0.0f) return found;
        const std::optional<uint32_t> texel = texelOfHit(input.atlas, input.irradianceTexels, hit);
        if (!texel) {
            found.light += throughput *
                           traceReflected(rays, lights, point, towardEye, maxBounces - bounce, rng, rayCount);
            return found;
        }
        found.light += throughput * punctualLight(rays, lights, point, towardEye, rng, rayCount);
        const glm::vec3 diffuse = diffuseAlbedo(point.brdf, towardEyeLocal);
        if (!areaIrradiance.empty())
            found.light += throughput * diffuse / kPi * unpackRgb9e5(areaIrradiance[*texel]);

        const SurfacePoint glossy = withoutDiffuse(point);
        const float specular = maxComponent(reflectance(glossy.brdf, towardEyeLocal));
        const float follow = specular / (specular + maxComponent(diffuse));
        if (rng.uniform() >= follow) {
            found.texel = *texel;
            found.weight = throughput * diffuse / (kPi * (1.0f - follow));
            return found;
        }
        throughput /= follow;
        if (lights.hasArea())
            found.light += throughput * areaLight(rays, lights, glossy, towardEye, rng, rayCount);

        const float lobe = rng.uniform();
        const BrdfSample sample = sampleBrdf(glossy.brdf, towardEyeLocal, lobe, rng.uniform2());
        if (sample.pdf <= 0.0f) return found;
        direction = glm::normalize(point.shading.toWorld(sample.direction));
        if (!leavesSurface(point, direction)) return found;
        throughput *= sample.weight;
        const float survival = survivalChance(bounce, throughput);
        if (survival < 1.0f && rng.uniform() >= survival) return found;
        throughput /= survival;

        ++rayCount;
        hit = rays.closestHit(originOn(point, direction), direction);
        const float weight = sample.pdf / (sample.pdf + areaPdf(lights, point.position, hit, direction));
        if (!hit) {
            found.light += throughput * weight * lights.environmentRadiance(direction);
            return found;
        }
        point = surfaceAt(rays.scene(), hit, direction);
        found.light += throughput * weight * point.emission;
        towardEye = -direction;
    }
    return found;
}

}  // namespace phat
