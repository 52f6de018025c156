#include "core/dynamic/block_order.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "core/dynamic/view_test.h"
#include "core/phatexel/directions.h"

namespace phat {
namespace {

// Rounds of blocks outside the view count as so many: they still light what is visible.
constexpr float kUnseenCount = 4;
// A check is due when others have had so many rounds: light that others make anew arrives by and by.
constexpr std::array<uint32_t, BlockOrder::kChecks> kCheckRounds = {0, 8, 32, 96};
// After so many rounds of an earlier change, a block is checked again before it is made again.
constexpr uint32_t kCalmRounds = 16;
// What a sample of irradiance is off after the filter, over the irradiance: as far as it may be off by what
// it was before the change, that counts.
constexpr float kFilteredNoise = 0.3f;
constexpr uint32_t kMaxKept = 64;

// PHATexels keep their last round alone, irradiance is the mean of all.
BlockWork workOf(uint32_t rounds) {
    const bool due = std::has_single_bit(rounds) && std::countr_zero(rounds) % 2 == 1;
    return due || rounds + 1 == BlockOrder::kSettledRounds ? BlockWork::all : BlockWork::irradiance;
}

uint32_t keptSamples(float change) {
    return uint32_t(std::clamp(square(kFilteredNoise / change), 1.0f, float(kMaxKept)));
}

// The part of a change that irradiance has not followed after so many samples.
float leftAfter(uint32_t samples, uint32_t kept) {
    return std::pow(float(kept) / float(kept + 1), float(samples));
}

}  // namespace

BlockOrder::BlockOrder(const Atlas& atlas, const TexelPoints& points) {
    const std::vector<BlockRect> rects = blockRects(atlas);
    const std::vector<Frame> frames = blockFrames(atlas, points);
    for (size_t block = 0; block < rects.size(); ++block) {
        const Bounds bounds = blockBounds(atlas, points, rects[block]);
        Place place;
        if (!bounds.empty()) place = {bounds.center(), frames[block].normal, 0.5f * bounds.diagonal()};
        places_.push_back(place);
    }
    states_.resize(places_.size());
    unsettled_ = places_.size();
}

bool BlockOrder::isSettled(const State& state) const {
    return state.changed ? state.rounds >= kSettledRounds : state.checks >= kChecks;
}

uint32_t BlockOrder::roundsOf(const State& state) const {
    return state.changed ? state.rounds : kCheckRounds[state.checks];
}

void BlockOrder::noteChange() {
    for (State& state : states_) {
        state.changed = state.changed && state.rounds < kCalmRounds;
        state.change *= state.changed ? leftAfter(state.rounds - 1, keptSamples(state.change)) : 0;
        state.checkDue = state.changed;
        state.rounds = state.changed ? 1 : 0;
        state.checks = 0;
    }
    unsettled_ = places_.size();
}

std::vector<BlockTurn> BlockOrder::next(size_t count, const Camera& eye) {
    const ViewTest view(eye);
    std::vector<std::pair<float, uint32_t>> order;
    for (uint32_t block = 0; block < places_.size(); ++block) {
        const State& state = states_[block];
        if (isSettled(state)) continue;
        const Place& place = places_[block];
        const bool seen = view.maySee(place.center, place.normal, place.radius);
        // Passes since its last turn, so that what begins anew again and again has turns, too.
        const float age = float(turns_ - state.turn) / float(places_.size());
        order.emplace_back(float(roundsOf(state)) * (seen ? 1.0f : kUnseenCount) - age, block);
    }
    count = std::min(count, order.size());
    std::partial_sort(order.begin(), order.begin() + ptrdiff_t(count), order.end());
    std::vector<BlockTurn> turns;
    for (size_t i = 0; i < count; ++i) {
        turns.push_back(turnOf(order[i].second));
        State& state = states_[order[i].second];
        state.turn = ++turns_;
        unsettled_ -= isSettled(state);
    }
    return turns;
}

BlockTurn BlockOrder::turnOf(uint32_t block) {
    State& state = states_[block];
    const uint32_t rounds = roundsOf(state);
    // Alternately: what changes all the time is checked all the time, and is to be lit, too.
    if (state.changed && !(state.checkDue && state.lit)) {
        ++state.rounds;
        state.lit = true;
        return {block, rounds, workOf(rounds), keptSamples(state.change)};
    }
    if (!state.changed) ++state.checks;
    state.checkDue = state.lit = false;
    return {block, rounds, BlockWork::check};
}

void BlockOrder::noteCheck(uint32_t block, float change) {
    State& state = states_[block];
    state.change += change;
    if (state.changed || state.change <= kAgrees) return;
    unsettled_ += isSettled(state);
    state.changed = true;
    state.rounds = 1;
}

}  // namespace phat
