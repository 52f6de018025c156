#pragma once
// Updates PHATexels: those that a change has invalidated in their stored directions, and whole blocks with
// new directions from the photon map.

#include <span>

#include "core/dynamic/baker_state.h"

namespace phat {

struct TileUpdate;
struct BlockUpdate;

class PhatexelUpdater {
  public:
    explicit PhatexelUpdater(BakerState& state);

    /// The first response to a change: tests the tiles' texels for occlusion again where the change
    /// may have altered it, and retraces the PHATexels that it may have changed. Returns the work.
    uint64_t retraceInvalidated(std::span<const uint32_t> tiles);
    /// Traces a part of the photon map, from which blocks take their guides. Returns the work.
    uint64_t tracePhotonPart(uint32_t part, Progress& progress);
    /// Updates all PHATexels of the blocks, with new guides and directions. Returns the work.
    uint64_t updateBlocks(std::span<const uint32_t> blocks);

    /// How many PHATexels have been updated so far.
    uint64_t updated() const { return updated_; }

  private:
    struct PhotonMapPart {
        explicit PhotonMapPart(PhotonMap traced) : map(std::move(traced)), index(map.photons) {}
        PhotonMap map;
        PhotonIndex index;
    };
    /// These compute, reading the state alone.
    TileUpdate updateTile(size_t tile, bool coverChanged) const;
    BlockUpdate updateBlock(uint32_t block) const;
    /// These commit what was computed.
    void commit(size_t tile, const TileUpdate& update);
    void commit(uint32_t block, const BlockUpdate& update);
    void updateScrambles(uint32_t block);

    BakerState& state_;
    std::vector<std::optional<PhotonMapPart>> photons_;  // parts in order
    uint64_t updated_ = 0;
};

/// Packs a tile's patch and depth probe for the renderer anew, after its block or its probe has changed.
void packTile(BakerState& state, size_t tile);

}  // namespace phat
