#include "core/dynamic/moved_objects.h"

#include <cassert>

namespace phat {
namespace {

// Items of a slice of work: some ten milliseconds, and enough for many threads.
constexpr size_t kBlocksPerSlice = 4, kGroupsPerSlice = 1024;

}  // namespace

bool MovedObjects::anyMoved() const {
    const size_t charts = state_.scene.atlas().charts.size();
    for (uint32_t c = 0; c < charts; ++c)
        if (state_.scene.movedAt(c) > version_) return true;
    return false;
}

void MovedObjects::beginRound() {
    charts_.assign(state_.scene.atlas().charts.size(), 0);
    for (uint32_t c = 0; c < charts_.size(); ++c) charts_[c] = state_.scene.movedAt(c) > version_;
    version_ = state_.scene.version();
    begin(state_.hasArea ? Step::estimates : Step::nodes);
}

void MovedObjects::begin(Step step) {
    step_ = step;
    items_.clear();
    next_ = 0;
    switch (step) {
        case Step::none:
            break;
        case Step::estimates:
            listBlocks();
            break;
        case Step::nodes:
            listNodeGroups();
            break;
        case Step::areaMap:
            maps_.beginCharts(MapKind::area, charts_);
            break;
        case Step::indirectMap:
            maps_.beginCharts(MapKind::indirect, charts_);
            break;
    }
}

void MovedObjects::listBlocks() {
    for (uint32_t c = 0; c < charts_.size(); ++c) {
        const Chart& chart = state_.scene.atlas().charts[c];
        for (uint32_t b = 0; hasChart(charts_, c) && b < chart.blocksWide() * chart.blocksHigh(); ++b)
            items_.push_back(chart.firstBlock + b);
    }
}

void MovedObjects::listNodeGroups() {
    const IrradianceLevel& level = state_.level;
    assert(state_.levelTexelsVersion == state_.scene.texelsVersion());
    for (uint32_t group = 0; group < level.node.size(); ++group) {
        const glm::uvec2 xy(group % level.size.x, group / level.size.x);
        if (level.node[group] != kNoNode && hasChart(charts_, state_.scene.atlas().chartAt(xy * level.step)))
            items_.push_back(group);
    }
}

std::span<const uint32_t> MovedObjects::takeItems(size_t count) {
    const size_t first = next_;
    next_ = std::min(first + count, items_.size());
    return std::span(items_).subspan(first, next_ - first);
}

uint64_t MovedObjects::advanceEstimates() {
    std::vector<BlockRect> blocks;
    for (const uint32_t block : takeItems(kBlocksPerSlice)) blocks.push_back(state_.blocks[block]);
    const uint64_t work = maps_.estimateArea(blocks);
    if (next_ == items_.size()) begin(Step::areaMap);
    return work;
}

uint64_t MovedObjects::advanceNodes() {
    std::vector<uint32_t> nodes;
    // Texels that were occluded meanwhile may have changed the nodes of their groups.
    for (const uint32_t group : takeItems(kGroupsPerSlice))
        for (uint32_t n = state_.level.node[group]; n != kNoNode; n = state_.level.next[n])
            nodes.push_back(n);
    const uint64_t work = maps_.traceNodes(nodes);
    if (next_ < items_.size()) return work;
    begin(Step::indirectMap);
    // At once, because it reads the nodes, whose number may change.
    return work + maps_.advanceCharts();
}

uint64_t MovedObjects::advance() {
    uint64_t work = 0;
    switch (step_) {
        case Step::none:
            beginRound();
            break;
        case Step::estimates:
            return advanceEstimates();
        case Step::areaMap:
            work = maps_.advanceCharts();
            if (!maps_.chartsAreRunning()) begin(Step::nodes);
            break;
        case Step::nodes:
            return advanceNodes();
        case Step::indirectMap:
            if (maps_.chartsAreRunning()) work = maps_.advanceCharts();
            if (maps_.chartsAreRunning()) break;
            begin(Step::none);
            ++rounds_;
            break;
    }
    return work;
}

}  // namespace phat
