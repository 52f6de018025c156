#pragma once
// Pictures of one material by something that is not a PHATexture, for the same camera and the same pixels.

#include <functional>
#include <string>

#include "core/render/picture.h"
#include "core/scene/shading.h"

namespace phat::peers {

/// Radiance that a surface point reflects toward the eye (unit).
using Shade = std::function<glm::vec3(const Hit& hit, const SurfacePoint& point, glm::vec3 towardEye)>;

/// Number of the material called `name`. Throws std::invalid_argument.
uint32_t materialNamed(const Scene& scene, const std::string& name);

inline uint32_t materialAt(const Scene& scene, uint32_t triangle) {
    return scene.surfaces[scene.triangleSurface[triangle]].material;
}

/// Black but for the visible points of `material`. `materials` is the rays' scene, or a copy of it whose
/// materials were changed after the bake. All must outlive the integrator.
Integrator peerIntegrator(const RayScene& rays, const Scene& materials, uint32_t material, Shade shade);

/// 1 where all four corners and the middle of a pixel show `material`: pixels without an edge in them.
Image materialMask(const RayScene& rays, uint32_t material, const Camera& camera, int width, int height);

/// Black outside so many pixels from (x, y) on.
void keepWindow(Image& mask, int x, int y, int width, int height);

/// `count` of the mask's pixels, or all if it has fewer, chosen at random and always the same ones.
Image thinned(const Image& mask, size_t count);

}  // namespace phat::peers
