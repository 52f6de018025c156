#pragma once
// Rays from a camera, and what an eye sees along a ray.

#include "core/scene/rays.h"

namespace phat {

/// The ray through `position` in pixels, (0, 0) the picture's upper left corner; it begins on the near plane.
/// twin: matricesOf in src/gl/camera_matrices.cpp, the rasteriser's camera.
Ray cameraRay(const Camera& camera, int width, int height, glm::vec2 position);

/// Whether a hit is on the back of a single-sided material, which eyes do not see and light does not pass.
bool isCulled(const Scene& scene, const Hit& hit);

/// The first visible hit along `ray`: backs of single-sided materials are skipped, as the rasteriser
/// culls them. (To all other rays they are black.) The hit's distance is from the ray's origin.
Hit visibleHit(const RayScene& rays, const Ray& ray, uint64_t& rayCount);
inline Hit visibleHit(const RayScene& rays, const Ray& ray) {
    uint64_t uncounted = 0;
    return visibleHit(rays, ray, uncounted);
}

/// The same behind all glass, straight on.
Hit visibleBehindGlass(const RayScene& rays, const Ray& ray);
/// The nearest hit on anything but glass, straight on.
Hit hitBehindGlass(const RayScene& rays, const Ray& ray);

}  // namespace phat
