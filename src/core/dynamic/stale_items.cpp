// The pieces of the incremental baker's work, by task.

#include <numeric>

#include "core/base/parallel.h"
#include "core/dynamic/incremental_baker.h"

namespace phat {
namespace {

// Items of a piece of work: some ten milliseconds, and enough for many threads.
constexpr size_t kTilesPerSlice = 64, kRegionsPerSlice = 4, kBlocksPerSlice = 8;
// In rays: tracing a photon and sorting it in.
constexpr uint64_t kPhotonWork = 4;

// Calls body(i) for all items at a time.
template <typename Body>
void forAll(size_t count, const Body& body) {
    SilentProgress silent;
    parallelRanges(count, 1, silent, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) body(i);
    });
}

}  // namespace

uint64_t IncrementalBaker::retraceInvalidated() {
    const std::span<const uint32_t> tiles = takeItems(BakerTask::retraceInvalidated, kTilesPerSlice);
    std::vector<uint8_t> coverAsked(tiles.size(), 0), coverChanged(tiles.size(), 0);
    forAll(tiles.size(), [&](size_t i) {
        coverAsked[i] = mayCover(state_, tiles[i]);
        if (coverAsked[i]) state_.scene.markCovered(tiles[i], *state_.rays);
    });
    uint64_t work = 0;
    bool anyChanged = false;
    for (size_t i = 0; i < tiles.size(); ++i) {
        if (!coverAsked[i]) continue;
        work += 16 * kTileTexels;
        coverChanged[i] = state_.scene.commitCovered(tiles[i]);
        if (coverChanged[i]) state_.tileDirty[tiles[i]] |= kDirtyCover;
        anyChanged |= coverChanged[i] != 0;
    }
    std::vector<TileUpdate> updates(tiles.size());
    forAll(tiles.size(), [&](size_t i) { updates[i] = updateTile(state_, tiles[i], coverChanged[i] != 0); });
    for (size_t i = 0; i < tiles.size(); ++i) {
        commit(state_, tiles[i], updates[i]);
        state_.tileClock[tiles[i]] = clock_;
        stats_.phatexels += updates[i].phatexels;
        work += updates[i].work;
    }
    // Rays end in texels, so what is covered matters to all of them.
    state_.scene.endCovered(anyChanged);
    queueVersion_ += anyChanged;
    return work;
}

uint64_t IncrementalBaker::tracePhotonPart(Progress& progress) {
    const uint32_t part = takeItems(BakerTask::photons, 1)[0];
    const uint64_t count = state_.settings.photons.count, parts = state_.photons.size();
    const uint64_t begin = count * part / parts, end = count * (part + 1) / parts;
    state_.photons[part].emplace(
        phat::tracePhotonPart(*state_.rays, *state_.lights, state_.settings.photons, begin, end, progress));
    state_.photonsScene[part] = state_.scene.version();
    return kPhotonWork * (end - begin);
}

uint64_t IncrementalBaker::estimateArea(std::span<const BlockPlace> places) {
    std::vector<uint64_t> rays(places.size(), 0);
    const GatherInput input = state_.input();
    forAll(places.size(), [&](size_t i) {
        renewAreaIrradiance(input, state_.settings, places[i].origin, places[i].size, state_.areaEstimates,
                            rays[i]);
    });
    areaDirty_ = true;
    const uint64_t work = std::accumulate(rays.begin(), rays.end(), uint64_t(0));
    areaWork_ += work;
    return work;
}

uint64_t IncrementalBaker::updateRegions() {
    const std::span<const uint32_t> regions = takeItems(BakerTask::areaLight, kRegionsPerSlice);
    const Atlas& atlas = state_.scene.atlas();
    const uint32_t wide = (atlas.sizeTexels.x + kBlockSize - 1) / kBlockSize;
    std::vector<BlockPlace> places;
    for (const uint32_t region : regions) {
        const glm::uvec2 corner = glm::uvec2(region % wide, region / wide) * kBlockSize;
        places.push_back({corner, glm::min(glm::uvec2(kBlockSize), atlas.sizeTexels - corner)});
        state_.regionScene[region] = state_.scene.version();
        state_.regionClock[region] = clock_;
    }
    return estimateArea(places);
}

uint64_t IncrementalBaker::traceNodes(std::span<const uint32_t> nodes) {
    std::vector<uint64_t> rays(nodes.size(), 0);
    const GatherInput input = state_.input();
    SilentProgress silent;
    parallelRanges(nodes.size(), 32, silent, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            state_.nodes[nodes[i]] = traceNode(input, state_.phatexture.areaIrradiance, state_.settings,
                                               state_.level, nodes[i], rays[i]);
    });
    uint64_t work = 0;
    for (size_t i = 0; i < nodes.size(); ++i) {
        state_.nodeAge[nodes[i]] = {state_.scene.version(), state_.areaVersion, clock_};
        work += rays[i];
    }
    indirectDirty_ = true;
    nodeWork_ += work;
    return work;
}

uint64_t IncrementalBaker::updateBlocks() {
    const std::span<const uint32_t> blocks = takeItems(BakerTask::blocks, kBlocksPerSlice);
    std::vector<BlockUpdate> updates(blocks.size());
    forAll(blocks.size(), [&](size_t i) { updates[i] = updateBlock(state_, blocks[i]); });
    uint64_t work = 0;
    for (size_t i = 0; i < blocks.size(); ++i) {
        commit(state_, blocks[i], updates[i]);
        state_.blockAge[blocks[i]].clock = clock_;
        stats_.phatexels += updates[i].phatexels;
        work += updates[i].work;
    }
    return work;
}

}  // namespace phat
