#pragma once
// Light that the GPU makes anew between the frames of the window.

#include <optional>

#include "core/dynamic/block_order.h"
#include "viewer/viewer_state.h"

namespace phat {

class LightRounds {
  public:
    /// Begins with the first change. `changed`: the light may be another one since the last call. A frame's
    /// part of the work is done; returns whether what is shown has changed.
    bool follow(ViewerState& state, bool changed);
    bool hasMore() const { return order_ && !order_->settled(); }

  private:
    std::optional<BlockOrder> order_;
    double blocksPerFrame_ = 8;  // by the time that the last ones took
    size_t unfiltered_ = 0;      // blocks that were made since irradiance was last filtered
    uint32_t number_ = 0;        // of the round
};

}  // namespace phat
