#pragma once
// What the incremental baker keeps between its steps: a bake with its intermediate results, each marked with
// the scene that it was made from.

#include <optional>

#include "core/bake/bake.h"
#include "core/bake/gather.h"
#include "core/bake/indirect_irradiance.h"
#include "core/bake/seam_stitch.h"
#include "core/dynamic/dynamic_scene.h"
#include "core/dynamic/light_update.h"

namespace phat {

/// A part of the photon map.
struct PhotonMapPart {
    explicit PhotonMapPart(PhotonMap traced) : map(std::move(traced)), index(map.photons) {}
    PhotonMap map;
    PhotonIndex index;
};

/// What a block's PHATexels were made from; 0: never.
struct BlockAge {
    uint64_t scene = 0, photons = 0, irradiance = 0;  // versions
    uint64_t clock = 0;
    uint64_t seed = 0;  // of its directions: the block's scrambles belong to it
};

/// What a node's rays were traced in; scene 0: never.
struct NodeAge {
    uint64_t scene = 0, area = 0;  // versions
    uint64_t clock = 0;
};

struct BakerState {
    BakerState(const Scene& rest, const Atlas& atlas, const TexelPoints& points, const Phatexture& baked,
               const BakeSettings& settings);

    /// After the scene has changed.
    void rebuildRays();
    GatherInput input() const {
        return {*rays,          *lights,   scene.atlas(), scene.points(),
                scene.frames(), noPhotons, *noIndex,      scene.irradianceTexels()};
    }
    const Guide& guideOf(const std::vector<Guide>& guides, uint32_t block) const {
        return guides[guides.size() == 1 ? 0 : block];
    }
    bool guided() const { return settings.directions == Directions::guided; }
    /// Version of the scene that the oldest part of the photon map is from.
    uint64_t photonsVersion() const;
    glm::uvec2 cornerOfTile(size_t tile) const {
        const uint32_t wide = scene.atlas().sizeTiles().x;
        return glm::uvec2(tile % wide, tile / wide) * kTileSize;
    }
    size_t texelOf(size_t tile, uint32_t inTile) const { return texelOfTile(scene.atlas(), tile, inTile); }

    DynamicScene scene;
    BakeSettings settings;
    bool hasArea = false;  // as the scene at rest
    std::optional<RayScene> rays;
    std::optional<LightSampler> lights;
    PhotonMap noPhotons;
    std::optional<PhotonIndex> noIndex;
    std::vector<SeamPoint> seams;
    std::vector<BlockPlace> blocks;

    Phatexture phatexture;
    std::vector<std::optional<PhotonMapPart>> photons;  // parts in order
    std::vector<IrradianceEstimate> areaEstimates;      // [y][x]
    IrradianceMap areaMap, indirectMap;                 // before their seams are stitched
    // Of refinement: how many times all light has been made anew of this very scene, and the means of the
    // maps before that.
    uint32_t pass = 0;
    IrradianceMap areaMean, indirectMean;
    IrradianceLevel level;  // of nodes
    std::vector<NodeRays> nodes;
    std::vector<NodeAge> nodeAge;
    uint64_t levelTexelsVersion = 0;  // of DynamicScene, that `level` was made from

    // Ages.
    std::vector<uint64_t> tileScene, tileClock;      // [tile]: changes that its PHATexels have heard of
    std::vector<uint64_t> photonsScene;              // [part]
    std::vector<uint64_t> regionScene, regionClock;  // [region of 32x32 texels]
    std::vector<BlockAge> blockAge;
    uint64_t areaVersion = 1, irradianceVersion = 1;
    bool irradianceKnown = false;  // the maps are those of the scene as it is

    // What the drawing side has not got yet.
    std::vector<uint8_t> tileDirty;  // bits of kDirty...
    std::vector<uint8_t> blockDirty;
};

inline constexpr uint8_t kDirtyPhatexels = 1, kDirtyIrradiance = 2, kDirtyPlace = 4, kDirtyCover = 8;

/// Mean of `passes` maps, whose own mean is `mean`, and one more.
IrradianceMap meanMap(const IrradianceMap& mean, const IrradianceMap& map, uint32_t passes);

/// All that is dirty, which it is no more; `tileLight` is left to the caller.
LightUpdate collectUpdate(BakerState& state);

}  // namespace phat
