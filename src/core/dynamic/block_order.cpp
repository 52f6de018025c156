#include "core/dynamic/block_order.h"

#include <algorithm>

#include "core/dynamic/view_test.h"
#include "core/phatexel/directions.h"

namespace phat {
namespace {

// Rounds of blocks outside the view count as so many: they still light what is visible.
constexpr float kUnseenCount = 4;

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
    rounds_.assign(places_.size(), 0);
    unsettled_ = places_.size();
}

void BlockOrder::noteChange() {
    std::fill(rounds_.begin(), rounds_.end(), 0u);
    unsettled_ = places_.size();
}

std::vector<BlockTurn> BlockOrder::next(size_t count, const Camera& eye) {
    const ViewTest view(eye);
    std::vector<uint32_t> order;
    std::vector<float> due(places_.size());
    for (uint32_t block = 0; block < places_.size(); ++block) {
        if (rounds_[block] >= kSettledRounds) continue;
        const Place& place = places_[block];
        const bool seen = view.maySee(place.center, place.normal, place.radius);
        due[block] = float(rounds_[block]) * (seen ? 1.0f : kUnseenCount);
        order.push_back(block);
    }
    count = std::min(count, order.size());
    std::partial_sort(order.begin(), order.begin() + ptrdiff_t(count), order.end(),
                      [&](uint32_t a, uint32_t b) { return due[a] != due[b] ? due[a] < due[b] : a < b; });
    std::vector<BlockTurn> turns;
    for (size_t i = 0; i < count; ++i) {
        turns.push_back({order[i], rounds_[order[i]]++});
        unsettled_ -= rounds_[order[i]] == kSettledRounds;
    }
    return turns;
}

}  // namespace phat
