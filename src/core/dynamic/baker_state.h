#pragma once
// State common to the parts of the incremental baker: the scene, its bake, and the version of the scene that
// each item of the bake was made from.

#include <optional>

#include "core/bake/bake.h"
#include "core/bake/gather.h"
#include "core/bake/indirect_irradiance.h"
#include "core/dynamic/dynamic_scene.h"
#include "core/dynamic/light_update.h"

namespace phat {

/// Versions that a block's PHATexels were computed from; 0: never.
struct BlockAge {
    uint64_t scene = 0, photons = 0, irradiance = 0;  // versions
    uint64_t clock = 0;
    uint64_t seed = 0;  // of its directions and of its scrambles
};

/// Version of the scene that a node's rays were traced in; 0: never.
struct NodeAge {
    uint64_t scene = 0, area = 0;  // versions
    uint64_t clock = 0;
};

struct BakerState {
    BakerState(SharedSnapshot rest, const Atlas& atlas, const TexelPoints& points, const Phatexture& baked,
               const BakeSettings& settings);

    /// To be called after the scene has changed: what reads `rays` and `lights` stays where it is and asks
    /// the scene of now. The environment is the baked one, which light is not updated for.
    void updateSceneQueries();
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
    bool hasArea = false;  // as the bake
    std::optional<RayScene> rays;
    std::optional<LightSampler> lights;
    PhotonMap noPhotons;
    std::optional<PhotonIndex> noIndex;
    std::vector<BlockRect> blocks;

    Phatexture phatexture;
    uint32_t pass = 0;      // of refinement: how often all light has been made anew of this very scene
    IrradianceLevel level;  // of nodes
    std::vector<NodeRays> nodes;
    std::vector<NodeAge> nodeAge;
    uint64_t levelTexelsVersion = 0;  // DynamicScene::texelsVersion() of `level`

    uint64_t clock = 0;     // all work so far, in rays or their equivalent in time
    uint64_t revision = 1;  // grows when items may have become stale

    // Ages: version of the scene that an item is up to date with, and the clock at its last update.
    std::vector<uint64_t> tileScene, tileClock;      // [tile]: of the retracing after changes
    std::vector<uint64_t> photonsScene;              // [part]
    std::vector<uint64_t> regionScene, regionClock;  // [region of 32x32 texels]
    std::vector<BlockAge> blockAge;
    uint64_t areaVersion = 1, irradianceVersion = 1;

    // Changes that the renderer has not been sent yet.
    std::vector<uint8_t> tileDirty;  // bits of kDirty...
    std::vector<uint8_t> blockDirty;
};

inline constexpr uint8_t kDirtyPhatexels = 1, kDirtyIrradiance = 2, kDirtyGeometry = 4, kDirtyCover = 8;

/// Takes all that is dirty, which it is no more; `tileLight` is left to the caller.
LightUpdate collectUpdate(BakerState& state);

}  // namespace phat
