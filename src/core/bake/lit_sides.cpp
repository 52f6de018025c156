#include "core/bake/lit_sides.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/base/median.h"
#include "core/scene/glass.h"

namespace phat {
namespace {

// A side that no photon found is dark without further ado if the other side has so many.
constexpr uint32_t kEnoughPhotons = 256;

/// What photons bring to a side.
struct SideLight {
    double fluxWatts = 0;
    uint32_t photons = 0;
};

/// W/m2: the median over the area of what the brighter sides receive. A mean would be that of the inside of
/// the brightest lamp shade.
double usualIrradiance(const Components& components, const std::vector<SideLight>& sides) {
    std::vector<std::pair<double, double>> lit;  // irradiance, area
    for (uint32_t c = 0; c < components.count(); ++c) {
        const double flux = std::max(sides[2 * c].fluxWatts, sides[2 * c + 1].fluxWatts);
        if (flux > 0 && components.area[c] > 0)
            lit.emplace_back(flux / components.area[c], components.area[c]);
    }
    return weightedMedianOf(std::move(lit));
}

// What photons bring to the sides of the components.
std::vector<SideLight> sidesUnder(const PhotonMap& photons, const Components& components) {
    std::vector<SideLight> sides(2 * size_t(components.count()));
    for (const Photon& photon : photons.photons) {
        SideLight& side = sides[2 * components.ofTriangle[photon.triangle] + photon.backFace];
        side.fluxWatts += double(luminance(photon.fluxWatts));
        ++side.photons;
    }
    return sides;
}

// The states before sides are asked what they see.
std::vector<SideState> statesUnder(const Scene& scene, const Components& components,
                                   const std::vector<SideLight>& sides, const LitLimits& limits) {
    const double usual = usualIrradiance(components, sides);
    std::vector<SideState> states(sides.size(), SideState::dark);
    for (uint32_t s = 0; s < sides.size(); ++s) {
        if (!isSide(scene, components, s)) continue;
        const uint32_t c = s / 2;
        const double irradiance = sides[s].fluxWatts / components.area[c];
        // The front may be the only side there is.
        const uint32_t enough = isSide(scene, components, s | 1) ? limits.photons : 1;
        if (sides[s].photons >= enough && irradiance >= limits.fraction * usual)
            states[s] = SideState::reached;
        else if (sides[s].photons > 0 || sides[s ^ 1].photons < kEnoughPhotons)
            states[s] = SideState::undecided;
    }
    return states;
}

}  // namespace

std::vector<SideState> litStates(const LitScene& lit, const Components& components, const PhotonMap& photons,
                                 const LitLimits& limits) {
    const Scene& scene = lit.rays.scene();
    std::vector<SideState> states = statesUnder(scene, components, sidesUnder(photons, components), limits);
    std::vector<std::vector<uint32_t>> meets(states.size());
    const auto met = [&](const Ray& ray) {
        uint64_t rayCount = 0;
        const Hit hit = seeStraight(lit.rays, ray, kFarDistance, rayCount).hit;
        if (hit) return components.sideOf(hit);
        return maxComponent(lit.lights.environmentRadiance(ray.direction)) > 0 ? kMeetsLight : kMeetsNothing;
    };
    tbb::parallel_for(uint32_t(0), uint32_t(states.size()), [&](uint32_t s) {
        if (states[s] == SideState::undecided) meets[s] = meetsFromSide(lit.rays, components, s, met);
    });
    spreadBySight(states, meets, limits.seen);
    return states;
}

std::vector<Sides> litSides(const LitScene& scene, const PhotonMap& photons,
                            std::vector<NeededSides>* clearlyLit) {
    const Components components = findComponents(scene.rays.scene());
    if (clearlyLit) *clearlyLit = neededSides(litStates(scene, components, photons, kClearlyLit));
    return reachedSides(litStates(scene, components, photons, kLit));
}

}  // namespace phat
