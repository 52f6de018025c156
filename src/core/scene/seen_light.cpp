#include "core/scene/seen_light.h"

#include <tbb/parallel_for.h>

#include "core/base/random.h"
#include "core/scene/camera_ray.h"
#include "core/scene/glass.h"
#include "core/scene/shading.h"

namespace phat {
namespace {

constexpr int kHeight = 20, kMaxWidth = 10 * kHeight;
constexpr float kAspect = 1.5f;  // of cameras that have none

// Samples of what is seen: all, and those that count.
template <class Count>
glm::ivec2 overPicture(const RayScene& rays, const Camera& camera, const Count& count) {
    const float aspect = camera.aspect > 0 ? camera.aspect : kAspect;
    const int width = int(std::clamp(std::round(aspect * kHeight), 1.0f, float(kMaxWidth)));
    std::vector<glm::ivec2> counts(size_t(width) * kHeight, glm::ivec2(0));
    tbb::parallel_for(size_t(0), counts.size(), [&](size_t i) {
        const glm::vec2 pixel(i % size_t(width), i / size_t(width));
        const Ray ray = cameraRay(camera, width, kHeight, pixel + 0.5f);
        if (const Hit hit = visibleBehindGlass(rays, ray)) counts[i] = count(i, ray, hit);
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
        const glm::vec3 normal = surfaceAt(scene, hit, direction).normalGeometric;
        origin = rays.offsetOrigin(origin + hit.distance * direction, normal);
        direction = glm::normalize(frameFromNormal(normal).toWorld(squareToCosineHemisphere(rng.uniform2())));
        hit = hitBehindGlass(rays, {origin, direction});
        if (!hit) return true;
        if (isCulled(scene, hit)) return false;  // a black back
    }
    return false;
}

// Whether light comes along a ray, through glass too.
bool isOpen(const RayScene& rays, const Ray& ray, float distance) {
    if (!rays.hasGlass()) return !rays.anyHit(ray.origin, ray.direction, distance);
    uint64_t count = 0;
    const StraightView view = seeStraight(rays, ray, distance, count);
    return !view.hit && maxComponent(view.transmittance) > 0;
}

bool isLit(const RayScene& rays, const LightSampler& lights, glm::vec3 point, glm::vec3 normal, Rng rng) {
    const auto reaches = [&](const LightSample& light) {
        return light.pdf > 0 && maxComponent(light.radiance) > 0 && glm::dot(light.towardLight, normal) > 0 &&
               isOpen(rays, {point, light.towardLight}, light.distance * (1 - 1e-4f));
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
