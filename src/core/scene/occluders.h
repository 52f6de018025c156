#pragma once
// Ellipsoids that stand for a thing where it keeps light from what is around it.

#include <array>
#include <vector>

#include "core/scene/scene.h"

namespace phat {

/// twin: kMaxOccluders in shaders/lib/contact_shadow.glsl and web/src/occluders.js.
inline constexpr size_t kMaxOccluders = 32;

/// By its shadow: along the unit direction d it has the area sqrt(d^T squaredShadow d), which is that of an
/// ellipsoid.
struct Occluder {
    glm::vec3 center{0};
    glm::mat3 squaredShadow{0};
};

/// The part of the irradiance of a surface under a uniform hemisphere that a sphere keeps away: exact, also
/// where the horizon cuts the sphere. 1 inside it. source: Snyder 1996,
/// in the form of Quilez 2006.
/// twin: sphereOcclusion in shaders/lib/contact_shadow.glsl.
float sphereOcclusion(glm::vec3 towardCenter, float radius, glm::vec3 normal);

/// The same of the sphere that has the occluder's shadow as seen from there, an approximation where that is
/// not round. twin: occlusionBy in shaders/lib/contact_shadow.glsl.
float occlusionBy(const Occluder& occluder, glm::vec3 position, glm::vec3 normal);

/// What stands for the opaque surfaces of things, at most kMaxOccluders. The box of each node is divided into
/// up to four cells along a side, about as long as wide, of one occluder each. With T the sum of A n n^T over
/// the cell's surfaces of areas A, and their whole area, its squared shadow is 3/16 area T: exact where these
/// are a sphere, in the mean over all directions where they are a cube; of a plate 13 % too small. twin:
/// occludersOf in web/src/occluders.js.
std::vector<Occluder> occludersOf(const Scene& things);

/// As shaders/lib/contact_shadow.glsl reads it.
std::array<glm::vec4, 3> rowsOf(const Occluder& occluder);

}  // namespace phat
