#pragma once
// The GPU's part of the light of blocks in turn.

#include "core/dynamic/block_order.h"
#include "gl/renderer.h"

namespace phat {

/// What `turns` are due for; the order learns what checks have found. `number`: of rounds so far. pre: the
/// light of the renderer is made by the GPU.
void takeTurns(Renderer& renderer, BlockOrder& order, std::span<const BlockTurn> turns, uint32_t& number);

}  // namespace phat
