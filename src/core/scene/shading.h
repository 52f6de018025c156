#pragma once
// From a triangle and barycentric coordinates to everything that light transport needs of a surface point.

#include "core/scene/brdf.h"
#include "core/scene/rays.h"
#include "core/scene/scene.h"

namespace phat {

/// Bilinear (or nearest) lookup; sRGB slots are decoded before filtering. White without an image.
glm::vec4 sampleTexture(const Scene& scene, const TextureSlot& slot, glm::vec2 uv, bool srgb);

struct SurfacePoint {
    glm::vec3 position{0};
    glm::vec3 normalGeometric{0, 0, 1};  // of the flat triangle, on the side that the viewer is on
    Frame shading;                       // interpolated and normal-mapped, same side; normal unit
    Brdf brdf;
    glm::vec3 emission{0};  // nit, toward the viewer's side
    uint32_t triangle = kNoTriangle;
    bool backFace = false;
};

/// The surface at a hit of a ray along `direction`, on the side that was hit.
/// The back of a single-sided material is black: no emission, no reflection.
SurfacePoint surfaceAt(const Scene& scene, const Hit& hit, glm::vec3 direction);

/// The same at barycentric coordinates of a triangle, seen from its front or back. Coordinates outside the
/// triangle (gutters) are clamped for textures and extrapolated for the position.
SurfacePoint surfaceAt(const Scene& scene, uint32_t triangle, glm::vec2 barycentric, bool back);

/// The surface at a hit of a transmissive material, whose back lets through what its front does, single-sided
/// or not.
SurfacePoint glassAt(const Scene& scene, const Hit& hit, glm::vec3 direction);
/// Metres: Material::thickness with its texture, scaled by the node.
float thicknessAt(const Scene& scene, const Hit& hit);

/// World, also outside the triangle.
glm::vec3 positionAt(const Scene& scene, uint32_t triangle, glm::vec2 barycentric);

/// Opacity after base colour, texture, vertex colour and cutoff: 0 or 1 for mask, [0,1] for blend.
float opacityAt(const Scene& scene, uint32_t triangle, glm::vec2 barycentric);

}  // namespace phat
