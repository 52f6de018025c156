#include "core/scene/camera_ray.h"

namespace phat {
namespace {

// The first hit along a ray that is not skipped; its distance is from the ray's origin.
template <class Skip>
Hit firstHit(const RayScene& rays, const Ray& ray, uint64_t& rayCount, const Skip& skip) {
    const Scene& scene = rays.scene();
    glm::vec3 origin = ray.origin;
    for (;;) {
        ++rayCount;
        Hit hit = rays.closestHit(origin, ray.direction);
        if (!hit) return hit;
        const glm::vec3 position = origin + hit.distance * ray.direction;
        if (!skip(hit)) {
            hit.distance = glm::distance(ray.origin, position);
            return hit;
        }
        const glm::uvec3 corner = scene.triangles[hit.triangle];
        const glm::vec3 a = scene.positions[corner.x];
        const glm::vec3 across = glm::cross(scene.positions[corner.y] - a, scene.positions[corner.z] - a);
        const glm::vec3 front = glm::normalize(across);
        const glm::vec3 beyond = rays.offsetOrigin(position, hit.backFace ? front : -front);
        // Where floats are too coarse to get past it, the ray ends rather than stays.
        if (!(glm::dot(beyond - origin, ray.direction) > 0)) return {};
        origin = beyond;
    }
}

}  // namespace

Ray cameraRay(const Camera& camera, int width, int height, glm::vec2 position) {
    const float aspect = float(width) / float(height);
    const glm::vec2 ndc(2 * position.x / float(width) - 1, 1 - 2 * position.y / float(height));
    const glm::mat3 rotation(camera.worldFromCamera);
    const glm::vec3 eye(camera.worldFromCamera[3]);
    const float nearMeters = std::max(camera.znear, 0.0f);
    if (camera.perspective) {
        const float half = std::tan(0.5f * camera.yfovRadians);
        const glm::vec3 toPlane = rotation * glm::vec3(ndc.x * half * aspect, ndc.y * half, -1);
        return {eye + nearMeters * toPlane, glm::normalize(toPlane)};
    }
    const glm::vec3 onPlane(ndc.x * camera.ymag * aspect, ndc.y * camera.ymag, -nearMeters);
    return {eye + rotation * onPlane, glm::normalize(rotation * glm::vec3(0, 0, -1))};
}

bool isCulled(const Scene& scene, const Hit& hit) {
    return hit.backFace && !scene.materialOf(hit.triangle).doubleSided;
}

Hit visibleHit(const RayScene& rays, const Ray& ray, uint64_t& rayCount) {
    return firstHit(rays, ray, rayCount, [&](const Hit& hit) { return isCulled(rays.scene(), hit); });
}

Hit visibleBehindGlass(const RayScene& rays, const Ray& ray) {
    uint64_t uncounted = 0;
    return firstHit(rays, ray, uncounted, [&](const Hit& hit) {
        return isCulled(rays.scene(), hit) || rays.glassOf(hit.triangle) != Glass::none;
    });
}

Hit hitBehindGlass(const RayScene& rays, const Ray& ray) {
    uint64_t uncounted = 0;
    return firstHit(rays, ray, uncounted,
                    [&](const Hit& hit) { return rays.glassOf(hit.triangle) != Glass::none; });
}

}  // namespace phat
