// Irradiance of what has moved. It rides on its object, so it is plainly out of place once that has turned,
// and it is little: it is renewed from estimates to map on its own, also while a map of all is being made.

#include "core/base/parallel.h"
#include "core/dynamic/incremental_baker.h"

namespace phat {
namespace {

// Items of a piece of work: some ten milliseconds, and enough for many threads.
constexpr size_t kEstimatedBlocksPerSlice = 4, kGroupsPerSlice = 1024;

}  // namespace

bool IncrementalBaker::anyMoved() const {
    const size_t charts = state_.scene.atlas().charts.size();
    for (uint32_t c = 0; c < charts; ++c)
        if (state_.scene.movedAt(c) > moved_.scene) return true;
    return false;
}

ChartSet IncrementalBaker::movedSince(uint64_t version) const {
    ChartSet charts(state_.scene.atlas().charts.size(), 0);
    for (uint32_t c = 0; c < charts.size(); ++c) charts[c] = state_.scene.movedAt(c) > version;
    return charts;
}

void IncrementalBaker::beginMovedStep(MovedLight::Step step) {
    using Step = MovedLight::Step;
    const Atlas& atlas = state_.scene.atlas();
    moved_.step = step;
    moved_.items.clear();
    moved_.next = 0;
    if (step == Step::estimates) {
        for (uint32_t c = 0; c < atlas.charts.size(); ++c) {
            const Chart& chart = atlas.charts[c];
            for (uint32_t b = 0; hasChart(moved_.charts, c) && b < chart.blocksWide() * chart.blocksHigh();
                 ++b)
                moved_.items.push_back(chart.firstBlock + b);
        }
    } else if (step == Step::nodes) {
        adaptNodes(state_);
        const IrradianceLevel& level = state_.level;
        for (uint32_t group = 0; group < level.node.size(); ++group) {
            const glm::uvec2 place(group % level.size.x, group / level.size.x);
            if (level.node[group] != kNoNode && hasChart(moved_.charts, atlas.chartAt(place * level.step)))
                moved_.items.push_back(group);
        }
    } else if (step != Step::none) {
        beginMap(moved_.job, step == Step::areaMap, moved_.charts);
    }
}

uint64_t IncrementalBaker::updateMoved() {
    using Step = MovedLight::Step;
    uint64_t work = 0;
    std::vector<BlockPlace> places;
    std::vector<uint32_t> nodes;
    const size_t first = moved_.next;
    const auto take = [&](size_t most) {
        moved_.next = std::min(first + most, moved_.items.size());
        return std::span(moved_.items).subspan(first, moved_.next - first);
    };
    switch (moved_.step) {
        case Step::none:
            moved_.charts = movedSince(moved_.scene);
            moved_.scene = state_.scene.version();
            beginMovedStep(state_.hasArea ? Step::estimates : Step::nodes);
            return 0;
        case Step::estimates:
            for (const uint32_t block : take(kEstimatedBlocksPerSlice))
                places.push_back(state_.blocks[block]);
            work = estimateArea(places);
            if (moved_.next == moved_.items.size()) beginMovedStep(Step::areaMap);
            return work;
        case Step::areaMap:
            work = advanceMap(moved_.job);
            if (!moved_.job) beginMovedStep(Step::nodes);
            return work;
        case Step::nodes:
            // What covers texels may have changed their nodes meanwhile.
            for (const uint32_t group : take(kGroupsPerSlice))
                if (state_.level.node[group] != kNoNode) nodes.push_back(state_.level.node[group]);
            work = traceNodes(nodes);
            if (moved_.next < moved_.items.size()) return work;
            beginMovedStep(Step::indirectMap);
            // At once, because it reads the nodes, whose number may change.
            return work + advanceMap(moved_.job);
        case Step::indirectMap:
            if (moved_.job) work = advanceMap(moved_.job);
            if (moved_.job) return work;
            beginMovedStep(Step::none);
            ++stats_.tasks[size_t(BakerTask::moved)].items;
            return work;
    }
    return work;
}

}  // namespace phat
