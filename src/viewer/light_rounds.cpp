#include "viewer/light_rounds.h"

#include <algorithm>
#include <chrono>

#include "core/base/stopwatch.h"
#include "gl/light_turns.h"

namespace phat {
namespace {

// Of a frame while somebody moves something, and of others.
constexpr double kMovingSeconds = 0.004, kRestingSeconds = 0.03;
constexpr auto kRest = std::chrono::milliseconds(500);
// Irradiance is filtered so many times while all blocks are made once.
constexpr size_t kFiltersPerPass = 4;

}  // namespace

bool LightRounds::follow(ViewerState& state, bool changed) {
    const BakedScene& baked = state.document->baked;
    if (!order_) {
        if (!changed || state.document->isAtRest()) return false;
        state.renderer->beginLight({state.document->scene(), baked.atlas, baked.points, baked.phatexture});
        order_.emplace(baked.atlas, baked.points);
    }
    if (changed) {
        order_->noteChange();
        state.renderer->unboundLight();
    }
    if (order_->settled()) return false;
    const std::vector<BlockTurn> turns = order_->next(size_t(blocksPerFrame_), state.navigation.camera);
    const Stopwatch watch;
    takeTurns(*state.renderer, *order_, turns, number_);
    state.renderer->waitForLight();
    const double seconds = std::max(watch.seconds(), 1e-5);
    const bool rests = std::chrono::steady_clock::now() - state.lastInput > kRest;
    const double budget = rests ? kRestingSeconds : kMovingSeconds;
    blocksPerFrame_ =
        std::clamp(blocksPerFrame_ * std::clamp(budget / seconds, 0.5, 2.0), 1.0, double(order_->size()));
    unfiltered_ += turns.size();
    if (unfiltered_ * kFiltersPerPass < order_->size() && !order_->settled()) return false;
    unfiltered_ = 0;
    state.renderer->filterLight();
    if (order_->settled()) state.renderer->boundLight();
    return true;
}

}  // namespace phat
