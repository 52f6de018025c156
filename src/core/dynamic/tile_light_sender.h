#pragma once
// The radiance bounds of tiles (tileLight) that the renderer is sent.

#include "core/dynamic/baker_state.h"

namespace phat {

class TileLightSender {
  public:
    /// Adds the bounds to the update where they are due. `converged`: PHATexels will not change any more.
    void addTo(LightUpdate& update, const BakerState& state, bool converged);

  private:
    std::vector<glm::vec4> tileLight_;  // as last computed
    bool stale_ = false;
    uint64_t sentVersion_ = 0;  // of the scene
    uint64_t dueClock_ = 0;     // of the next computation
};

}  // namespace phat
