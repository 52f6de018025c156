#pragma once
// What the sides of connected pieces of surface see of each other.

#include <cstdint>
#include <functional>
#include <vector>

#include "core/atlas/earlier_charts.h"
#include "core/scene/rays.h"

namespace phat {

/// The connected components of a scene. The sides of component c are 2 c, its front, and 2 c + 1.
struct Components {
    std::vector<uint32_t> ofTriangle;
    std::vector<uint32_t> first, triangle;  // triangles listed by component
    std::vector<double> area;               // per component, square metres
    std::vector<double> areaUpTo;           // per element of `triangle`: of its component, itself included

    uint32_t count() const { return uint32_t(area.size()); }
    uint32_t sideOf(const Hit& hit) const { return 2 * ofTriangle[hit.triangle] + hit.backFace; }
};
Components findComponents(const Scene& scene);

/// Whether a side can be seen at all: single-sided surfaces have no back.
bool isSide(const Scene& scene, const Components& components, uint32_t side);

/// What a ray meets if not a side: darkness, or where light comes from.
inline constexpr uint32_t kMeetsNothing = ~0u, kMeetsLight = ~0u - 1;

/// A crack of a millimetre in a wall of two metres lets one ray in a thousand through.
inline constexpr uint32_t kSideRays = 128;

/// What kSideRays cosine-distributed rays from everywhere on a side meet, according to `met`; ray by ray the
/// same for every `met`.
using MeetsOfRay = std::function<uint32_t(const Ray&)>;
std::vector<uint32_t> meetsFromSide(const RayScene& rays, const Components& components, uint32_t side,
                                    const MeetsOfRay& met);

enum class SideState : uint8_t { dark, undecided, reached };

/// Reaches the undecided sides of which `minSeen` rays meet light or a side that is reached, until there are
/// no more. `meets`: per side, of meetsFromSide; empty where it was not asked for.
void spreadBySight(std::vector<SideState>& states, const std::vector<std::vector<uint32_t>>& meets,
                   uint32_t minSeen);

/// Per component, of the states of its sides: the front where neither is reached.
std::vector<Sides> reachedSides(const std::vector<SideState>& states);
std::vector<NeededSides> neededSides(const std::vector<SideState>& states);

}  // namespace phat
