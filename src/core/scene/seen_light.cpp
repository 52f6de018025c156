#include "core/scene/seen_light.h"

#include <tbb/parallel_for.h>

#include "core/base/random.h"
#include "core/scene/enclosure.h"
#include "core/scene/shading.h"

namespace phat {
namespace {

constexpr int kWidth = 30, kHeight = 20;
constexpr float kAspect = 1.5f;  // of cameras that have none

glm::vec3 cornerOf(const Scene& scene, uint32_t triangle, int corner) {
    return scene.positions[scene.triangles[triangle][corner]];
}

Ray rayOf(const Camera& camera, size_t pixel) {
    const float aspect = camera.aspect > 0 ? camera.aspect : kAspect;
    const glm::vec2 at(aspect * ((float(pixel % kWidth) + 0.5f) / kWidth * 2 - 1),
                       (float(pixel / kWidth) + 0.5f) / kHeight * 2 - 1);
    const glm::mat3 turn(camera.worldFromCamera);
    const glm::vec3 eye(camera.worldFromCamera[3]);
    if (!camera.perspective) return {eye + turn * glm::vec3(at * camera.ymag, 0), -turn[2]};
    const float slope = std::tan(0.5f * camera.yfovRadians);
    return {eye, glm::normalize(turn * glm::vec3(at * slope, -1))};
}

// Samples of what is seen: all, and those that count.
template <class Count>
glm::ivec2 overPicture(const RayScene& rays, const Camera& camera, const Count& count) {
    std::vector<glm::ivec2> counts(size_t(kWidth) * kHeight, glm::ivec2(0));
    tbb::parallel_for(size_t(0), counts.size(), [&](size_t i) {
        const Ray ray = rayOf(camera, i);
        if (const Hit hit = seenFrom(rays, ray.origin, ray.direction)) counts[i] = count(i, ray, hit);
    });
    glm::ivec2 sum(0);
    for (const glm::ivec2& pixel : counts) sum += pixel;
    return sum;
}

// Whether a diffuse walk from a seen point leaves the scene.
bool reachesSky(const RayScene& rays, glm::vec3 origin, glm::vec3 direction, Hit hit, Rng rng) {
    constexpr int kBounces = 6;
    const Scene& scene = rays.scene();
    for (int bounce = 0; bounce <= kBounces; ++bounce) {
        const uint32_t t = hit.triangle;
        const glm::vec3 across = glm::cross(cornerOf(scene, t, 1) - cornerOf(scene, t, 0),
                                            cornerOf(scene, t, 2) - cornerOf(scene, t, 0));
        const float length = glm::length(across);
        if (!(length > 0)) return false;
        const glm::vec3 normal = across / (glm::dot(across, direction) > 0 ? -length : length);
        const glm::vec2 u = rng.uniform2();
        const float radius = std::sqrt(u.x), angle = 2 * kPi * u.y;
        const glm::vec3 local(radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - u.x));
        origin = rays.offsetOrigin(origin + hit.distance * direction, normal);
        direction = glm::normalize(frameFromNormal(normal).toWorld(local));
        hit = rays.closestHit(origin, direction);
        if (!hit) return true;
        if (isCulled(scene, hit)) return false;  // a black back
    }
    return false;
}

bool isLit(const RayScene& rays, const LightSampler& lights, glm::vec3 point, glm::vec3 normal, Rng rng) {
    const auto reaches = [&](const LightSample& light) {
        return light.pdf > 0 && maxComponent(light.radiance) > 0 && glm::dot(light.towardLight, normal) > 0 &&
               !rays.anyHit(point, light.towardLight, light.distance * (1 - 1e-4f));
    };
    for (size_t i = 0; i < rays.scene().lights.size(); ++i)
        if (reaches(lights.samplePunctual(i, point))) return true;
    constexpr int kAreaSamples = 4;
    for (int i = 0; i < kAreaSamples; ++i) {
        const float choice = rng.uniform();
        if (reaches(lights.sampleArea(point, choice, rng.uniform2()))) return true;
    }
    return false;
}

}  // namespace

float daylightFraction(const RayScene& rays, const Camera& camera) {
    constexpr int kDaylightWalks = 4;
    const glm::ivec2 sum = overPicture(rays, camera, [&](size_t pixel, const Ray& ray, const Hit& hit) {
        glm::ivec2 count(kDaylightWalks, 0);
        for (int walk = 0; walk < kDaylightWalks; ++walk)
            count.y += reachesSky(rays, ray.origin, ray.direction, hit, Rng(hashOf(pixel, uint64_t(walk))));
        return count;
    });
    return sum.x > 0 ? float(sum.y) / float(sum.x) : 1.0f;
}

float litFraction(const RayScene& rays, const LightSampler& lights, const Camera& camera) {
    const glm::ivec2 sum = overPicture(rays, camera, [&](size_t pixel, const Ray& ray, const Hit& hit) {
        const SurfacePoint surface = surfaceAt(rays.scene(), hit, ray.direction);
        if (maxComponent(surface.emission) > 0) return glm::ivec2(0);
        const glm::vec3 normal = surface.normalGeometric;
        return glm::ivec2(1, int(isLit(rays, lights, rays.offsetOrigin(surface.position, normal), normal,
                                       Rng(hashOf(pixel)))));
    });
    return sum.x > 0 ? float(sum.y) / float(sum.x) : 1.0f;
}

}  // namespace phat
