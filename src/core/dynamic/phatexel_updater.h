#pragma once
// ResumableTask of work of the incremental baker. Each first computes, reading the state alone, then commits.

#include "core/dynamic/baker_state.h"

namespace phat {

/// A tile's PHATexels whose rays meet what has changed, again in the same directions: the first answer to a
/// change.
struct TileUpdate {
    std::vector<PackedPhatexel> texels;  // as LightUpdate::Phatexels; empty: nothing has changed
    DistanceProbe probe;
    uint64_t work = 0;  // rays, or as long as so many take
    uint32_t phatexels = 0;
};
/// Whether a change may have covered or uncovered texels of the tile.
bool mayCover(const BakerState& state, size_t tile);
/// `coverChanged`: some of its texels are covered, or bare, only now.
TileUpdate updateTile(const BakerState& state, size_t tile, bool coverChanged);
void commit(BakerState& state, size_t tile, const TileUpdate& update);

/// All of a block: guides from the photons as they are, new directions, rays.
struct BlockUpdate {
    Guide indirectGuide, areaGuide;
    std::vector<std::vector<PackedPhatexel>> indirect;  // [layer][y][x] of the block's place
    std::vector<PackedPhatexel> area;
    std::vector<DistanceProbe> probes;  // of its tiles [y][x]
    uint64_t work = 0;
    uint32_t phatexels = 0;
};
BlockUpdate updateBlock(const BakerState& state, uint32_t block);
void commit(BakerState& state, uint32_t block, const BlockUpdate& update);

/// Renews what the drawing side knows of a tile's place, after its block or its probe has changed.
void packPlace(BakerState& state, size_t tile);

/// Adapts the nodes of indirect irradiance to the texels that are covered now. Returns their number.
size_t adaptNodes(BakerState& state);
bool allNodesKnown(const BakerState& state);

/// Publishes a map; returns whether it differs from the one before.
bool publish(BakerState& state, std::vector<uint32_t>& map, std::vector<uint32_t> renewed);

}  // namespace phat
