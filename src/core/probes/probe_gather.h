#pragma once
// The light and the distances around one probe, by rays.

#include "core/bake/irradiance_ray.h"
#include "core/probes/light_probes.h"

namespace phat {

/// What rays from a probe are shaded by: a finished bake.
struct ProbeWorld {
    const TexelWorld& texels;
    const TexelIrradiance& irradiance;
    uint64_t seed = 1;
};

/// A probe's rays, before they are packed.
struct ProbeRays {
    glm::vec3 position{0};
    IrradianceSh indirect, area;
    std::array<float, kDistanceNodes * kDistanceNodes> reciprocalDistance{};  // see packDistances
};

/// Gathers at a corner of the grid. Where a surface is nearer than `clearance`, the probe is moved away from
/// it by at most that. `index` selects the random numbers.
ProbeRays gatherProbe(const ProbeWorld& world, glm::vec3 corner, float clearance, uint64_t index,
                      uint64_t& rayCount);

}  // namespace phat
