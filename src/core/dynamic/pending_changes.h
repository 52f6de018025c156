#pragma once
// Which PHATexels the changes of the scene have made stale.

#include "core/dynamic/baker_state.h"

namespace phat {

/// The changes that a tile has not been updated for.
class PendingChanges {
  public:
    PendingChanges(const BakerState& state, size_t tile);

    /// Whether the tile itself has moved.
    bool moved() const { return moved_; }
    /// Whether they may have occluded or exposed texels of the tile.
    bool mayCover(const TilePatch& patch) const;
    /// Whether they may have changed the light that arrives along a PHATexel's ray of length `stored`.
    bool affectRay(const Scene& scene, glm::vec3 origin, glm::vec3 direction, float stored) const;

  private:
    std::vector<Bounds> surfaceBoxes_, lightBoxes_;
    bool moved_ = false;
};

}  // namespace phat
