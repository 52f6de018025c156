#include "gl/light_turns.h"

#include <algorithm>

namespace phat {

void takeTurns(Renderer& renderer, BlockOrder& order, std::span<const BlockTurn> turns, uint32_t& number) {
    const auto dueFor = [&](BlockWork work) {
        std::vector<BlockTurn> due;
        std::copy_if(turns.begin(), turns.end(), std::back_inserter(due),
                     [&](const BlockTurn& turn) { return turn.work == work; });
        return due;
    };
    const std::vector<BlockTurn> checked = dueFor(BlockWork::check);
    const std::vector<float> changes =
        renderer.traceLight({.blocks = checked, .number = ++number, .irradiance = false, .compares = true});
    for (size_t i = 0; i < checked.size(); ++i) order.noteCheck(checked[i].block, changes[i]);
    const std::vector<BlockTurn> lit = dueFor(BlockWork::irradiance), all = dueFor(BlockWork::all);
    renderer.traceLight({.blocks = lit, .number = ++number, .phatexels = false});
    renderer.traceLight({.blocks = all, .number = ++number, .directions = RayChoice::guided});
}

}  // namespace phat
