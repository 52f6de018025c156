#pragma once
// The slow stages: light per texel. Each can be done in parts and taken up again.

#include <atomic>

#include "core/bake/bake.h"
#include "core/bake/irradiance.h"
#include "core/phatexel/directions.h"
#include "core/transport/path.h"

namespace phat {

struct TexelIrradiance;

/// Input of the gathering stages.
struct GatherInput {
    const RayScene& rays;
    const LightSampler& lights;
    const Atlas& atlas;
    const TexelPoints& points;
    const std::vector<Frame>& frames;
    const PhotonMap& photons;
    const PhotonIndex& index;
    const std::vector<uint8_t>& irradianceTexels;  // [y][x], as the function of that name

    LitScene scene() const { return {rays, lights}; }
    BlockGeometry blocks() const { return {atlas, points, frames}; }
    ReceiverTexels receivers() const { return {atlas, points, irradianceTexels}; }
};

/// What an earlier bake had of the same input; null: not the same.
struct SameLight {
    const Phatexture* areaLight = nullptr;  // guides and PHATexels
    const Phatexture* areaIrradiance = nullptr;
    const Phatexture* distances = nullptr;
};

/// A run of the gathering stages: input, progress and journal.
struct GatherContext {
    GatherInput input;
    const BakeSettings& settings;
    Progress& progress;
    BakeJournal* journal;  // null: an interrupted run begins anew
    std::atomic<uint64_t>& rayCount;
    uint64_t sliceWork = kNoSlicing;  // rays between two yields of a ResumableTask
    SameLight same = {};              // is taken over
};

/// All that a bake gathers for the texels of an atlas, whatever they are in the scene by now.
Phatexture gatherLight(const GatherContext& context);

/// A layer of PHATexels of light that was reflected at least once.
struct IndirectLayer {
    const GatherInput& input;
    const TexelIrradiance& irradiance;  // read by RadianceSource::texels
    const BakeSettings& settings;
    int layer;
};

/// One PHATexel of the layer, as gatherIndirect makes it.
PackedPhatexel indirectPhatexel(const IndirectLayer& layer, const TexelDirection& direction, size_t texel,
                                uint64_t& rays);
/// The same of light straight from emissive surfaces and the environment.
PackedPhatexel areaPhatexel(const GatherInput& input, const TexelDirection& direction, size_t texel,
                            uint64_t& rays);

/// PHATexels of light that was reflected at least once: one ray each, its value by `settings.radiance`.
/// A direction below its own texel's horizon (the block's frame is a mean) gives an invalid PHATexel.
/// `irradiance` is what RadianceSource::texels reads.
PhatexelLayer gatherIndirect(const GatherContext& context, const ChosenDirections& chosen,
                             const TexelIrradiance& irradiance, int layer);

/// PHATexels of light straight from emissive surfaces and the environment.
PhatexelLayer gatherArea(const GatherContext& context, const ChosenDirections& chosen);

/// Estimates of the irradiance of emissive surfaces and the environment, [y][x].
std::vector<IrradianceEstimate> gatherAreaIrradiance(const GatherContext& context);

/// The same for a rectangle of texels inside the atlas, into their elements of `estimates`.
void updateAreaIrradiance(const GatherInput& input, const BakeSettings& settings, glm::uvec2 corner,
                          glm::uvec2 size, std::vector<IrradianceEstimate>& estimates, uint64_t& rays);

/// Irradiance of all light that was reflected at least once, [y][x], everywhere in the charts, by rays of its
/// own and smooth; it does not depend on the PHATexels. `areaIrradiance`: as Phatexture's, what surfaces are
/// lit by.
IrradianceMap gatherIndirectIrradiance(const GatherContext& context,
                                       const std::vector<uint32_t>& areaIrradiance);

}  // namespace phat
