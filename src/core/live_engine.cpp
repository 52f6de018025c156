#include "core/live_engine.h"

#include <chrono>

#include "core/irradiance_finish.h"
#include "core/parallel.h"
#include "core/tile_light.h"

namespace phat {
namespace {

// Items of a piece of work: some ten milliseconds, and enough for many threads.
constexpr size_t kTilesAPiece = 64, kRegionsAPiece = 4, kNodesAPiece = 1024, kBlocksAPiece = 8;
// In rays: tracing a photon and sorting it in; a texel of the area lights' map and of the indirect one.
constexpr uint64_t kPhotonWork = 4, kAreaMapWork = 2, kIndirectMapWork = 6;
// Maps are made anew when the work on what they are made from outweighs them so many times.
constexpr uint64_t kMapShare = 3;
// So many texels are stitched and packed in the time of a ray.
constexpr uint64_t kTexelsStitchedAWork = 8;
// A pass over everything, in rays a texel: by its age an item's urgency grows by 1 in that time.
constexpr uint64_t kPassWork = 64;

// Tiles' brightest light is looked for anew after so much work, in rays a texel.
constexpr uint64_t kTileLightWork = 1;

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Stops when another does, and reports nothing: pieces are too small to be stages.
class OnlyStop : public SilentProgress {
  public:
    explicit OnlyStop(const Progress& of) : of_(of) {}
    bool stopRequested() const override { return of_.stopRequested(); }

  private:
    const Progress& of_;
};

// Calls body(i) for all items at a time.
template <typename Body>
void forAll(size_t count, const Body& body) {
    SilentProgress silent;
    parallelRanges(count, 1, silent, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) body(i);
    });
}

}  // namespace

LiveEngine::LiveEngine(const Scene& rest, const Atlas& atlas, const TexelPoints& points,
                       const Phatexture& baked, const BakeSettings& settings)
    : state_(rest, atlas, points, baked, settings) {
    adaptNodes(state_);
    indirectDirty_ = true;
}

bool LiveEngine::setPose(const LivePose& pose) {
    if (!state_.scene.set(pose)) return false;
    state_.rebuildRays();
    const uint64_t version = state_.scene.version();
    for (size_t tile = 0; tile < state_.tileDirty.size(); ++tile) {
        const uint32_t chart = state_.scene.atlas().tileChart[tile];
        if (chart != kNoChart && state_.scene.movedAt(chart) == version) packPlace(state_, tile);
    }
    ++plan_;
    return true;
}

void LiveEngine::setEye(const Camera* eye) {
    eye_ = eye ? std::optional<Camera>(*eye) : std::nullopt;
    valuesFor_ = 0;
}

bool LiveEngine::hasWork(LiveTask task) {
    Queue& queue = queues_[size_t(task)];
    if (queue.planned == plan_ && queue.next < queue.items.size()) return true;
    if (queue.planned != plan_) {
        if (valuesFor_ != state_.scene.version()) {
            tileValue_ = tileValues(state_, eye_ ? &*eye_ : nullptr);
            valuesFor_ = state_.scene.version();
        }
        if (task == LiveTask::nodes) adaptNodes(state_);
        if (task == LiveTask::blocks)
            state_.irradianceKnown =
                !areaDirty_ && !indirectDirty_ && !hasWork(LiveTask::areaLight) && !hasWork(LiveTask::nodes);
        queue.items = urgentFirst(state_, task, tileValue_, clock_,
                                  kPassWork * state_.scene.atlas().texelCount(), queue.movedItems);
        queue.next = 0;
        queue.planned = plan_;
    }
    return queue.next < queue.items.size();
}

std::span<const uint32_t> LiveEngine::takeItems(LiveTask task, size_t most) {
    Queue& queue = queues_[size_t(task)];
    const size_t first = queue.next;
    queue.next = std::min(first + most, queue.items.size());
    return std::span(queue.items).subspan(first, queue.next - first);
}

bool LiveEngine::settled() {
    if (areaDirty_ || indirectDirty_) return false;
    for (size_t t = 0; t < kLiveTasks; ++t)
        if (hasWork(LiveTask(t))) return false;
    return true;
}

uint64_t LiveEngine::advance(uint64_t work, const Progress& whole) {
    OnlyStop progress(whole);
    const uint64_t start = clock_;
    credit_ += int64_t(work);
    while (credit_ > 0) {
        progress.throwIfStopped();
        const uint64_t before = clock_;
        if (areaIsDue()) {
            finishArea({}, progress);
        } else if (indirectIsDue()) {
            finishIndirect({}, progress);
        } else if (movedIsDue(LiveTask::areaLight)) {
            finishArea(movedSince(areaMapScene_), progress);
        } else if (movedIsDue(LiveTask::nodes) && allNodesKnown(state_)) {
            finishIndirect(movedSince(indirectMapScene_), progress);
        } else {
            std::array<bool, kLiveTasks> busy;
            for (size_t t = 0; t < kLiveTasks; ++t) busy[t] = hasWork(LiveTask(t));
            const std::optional<LiveTask> task = shares_.next(busy);
            if (!task) {
                credit_ = 0;
                break;
            }
            runPiece(*task, progress);
        }
        credit_ -= int64_t(clock_ - before);
    }
    return clock_ - start;
}

void LiveEngine::runPiece(LiveTask task, Progress& progress) {
    const Clock::time_point start = Clock::now();
    Queue& queue = queues_[size_t(task)];
    const size_t before = queue.next;
    uint64_t work = 0;
    switch (task) {
        case LiveTask::respond:
            work = respond();
            break;
        case LiveTask::photons:
            work = tracePhotonPart(progress);
            break;
        case LiveTask::areaLight:
            work = renewRegions();
            break;
        case LiveTask::nodes:
            work = traceNodes();
            break;
        case LiveTask::blocks:
            work = renewBlocks();
            break;
    }
    // What is stale may depend on all of a kind being known.
    if (queue.next == queue.items.size()) ++plan_;
    if (before < queue.movedItems) {
        queue.movedWork += work;
        queue.movedDone = queue.next >= queue.movedItems;
    }
    clock_ += work;
    shares_.done(task, work);
    LiveStats::Task& stats = stats_.tasks[size_t(task)];
    stats.items += queue.next - before;
    stats.work += work;
    stats.seconds += secondsSince(start);
}

uint64_t LiveEngine::respond() {
    const std::span<const uint32_t> tiles = takeItems(LiveTask::respond, kTilesAPiece);
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
    std::vector<TileRenewal> renewals(tiles.size());
    forAll(tiles.size(), [&](size_t i) { renewals[i] = renewTile(state_, tiles[i], coverChanged[i] != 0); });
    for (size_t i = 0; i < tiles.size(); ++i) {
        commit(state_, tiles[i], renewals[i]);
        state_.tileClock[tiles[i]] = clock_;
        stats_.phatexels += renewals[i].phatexels;
        work += renewals[i].work;
    }
    // Rays end in texels, so what is covered matters to all of them.
    state_.scene.endCovered(anyChanged);
    plan_ += anyChanged;
    return work;
}

uint64_t LiveEngine::tracePhotonPart(Progress& progress) {
    const uint32_t part = takeItems(LiveTask::photons, 1)[0];
    const uint64_t count = state_.settings.photons.count, parts = state_.photons.size();
    const uint64_t begin = count * part / parts, end = count * (part + 1) / parts;
    state_.photons[part].emplace(
        phat::tracePhotonPart(*state_.rays, *state_.lights, state_.settings.photons, begin, end, progress));
    state_.photonsScene[part] = state_.scene.version();
    return kPhotonWork * (end - begin);
}

uint64_t LiveEngine::renewRegions() {
    const std::span<const uint32_t> regions = takeItems(LiveTask::areaLight, kRegionsAPiece);
    const Atlas& atlas = state_.scene.atlas();
    const uint32_t wide = (atlas.sizeTexels.x + kBlockSize - 1) / kBlockSize;
    std::vector<uint64_t> rays(regions.size(), 0);
    const GatherInput input = state_.input();
    forAll(regions.size(), [&](size_t i) {
        const glm::uvec2 corner = glm::uvec2(regions[i] % wide, regions[i] / wide) * kBlockSize;
        renewAreaIrradiance(input, state_.settings, corner,
                            glm::min(glm::uvec2(kBlockSize), atlas.sizeTexels - corner), state_.areaEstimates,
                            rays[i]);
    });
    uint64_t work = 0;
    for (size_t i = 0; i < regions.size(); ++i) {
        state_.regionScene[regions[i]] = state_.scene.version();
        state_.regionClock[regions[i]] = clock_;
        work += rays[i];
    }
    areaDirty_ = true;
    areaWork_ += work;
    return work;
}

uint64_t LiveEngine::traceNodes() {
    const std::span<const uint32_t> nodes = takeItems(LiveTask::nodes, kNodesAPiece);
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

uint64_t LiveEngine::renewBlocks() {
    const std::span<const uint32_t> blocks = takeItems(LiveTask::blocks, kBlocksAPiece);
    std::vector<BlockRenewal> renewals(blocks.size());
    forAll(blocks.size(), [&](size_t i) { renewals[i] = renewBlock(state_, blocks[i]); });
    uint64_t work = 0;
    for (size_t i = 0; i < blocks.size(); ++i) {
        commit(state_, blocks[i], renewals[i]);
        state_.blockAge[blocks[i]].clock = clock_;
        stats_.phatexels += renewals[i].phatexels;
        work += renewals[i].work;
    }
    return work;
}

bool LiveEngine::areaIsDue() {
    if (!areaDirty_) return false;
    return !hasWork(LiveTask::areaLight) ||
           areaWork_ > kMapShare * kAreaMapWork * state_.scene.atlas().texelCount();
}

bool LiveEngine::indirectIsDue() {
    if (!indirectDirty_) return false;
    const bool all = !hasWork(LiveTask::nodes);
    if (!all && nodeWork_ <= kMapShare * kIndirectMapWork * state_.scene.atlas().texelCount()) return false;
    return allNodesKnown(state_);
}

uint64_t LiveEngine::mapWork(uint64_t workATexel, const ChartSet& charts) const {
    const Atlas& atlas = state_.scene.atlas();
    uint64_t texels = 0;
    for (uint32_t c = 0; c < atlas.charts.size(); ++c)
        if (hasChart(charts, c))
            texels += uint64_t(atlas.charts[c].sizeTexels().x) * atlas.charts[c].sizeTexels().y;
    return workATexel * texels + atlas.texelCount() / kTexelsStitchedAWork;
}

ChartSet LiveEngine::movedSince(uint64_t version) const {
    ChartSet charts(state_.scene.atlas().charts.size(), 0);
    for (uint32_t c = 0; c < charts.size(); ++c) charts[c] = state_.scene.movedAt(c) > version;
    return charts;
}

bool LiveEngine::movedIsDue(LiveTask task) {
    const Queue& queue = queues_[size_t(task)];
    if (queue.movedWork == 0) return false;
    if (queue.movedDone) return true;
    const bool area = task == LiveTask::areaLight;
    return queue.movedWork > kMapShare * mapWork(area ? kAreaMapWork : kIndirectMapWork,
                                                 movedSince(area ? areaMapScene_ : indirectMapScene_));
}

namespace {

void mix(IrradianceMap& map, IrradianceMap renewed, const ChartSet& charts, const Atlas& atlas) {
    if (charts.empty()) {
        map = std::move(renewed);
        return;
    }
    for (size_t i = 0; i < map.size(); ++i)
        if (hasChart(charts, atlas.chartAt({i % atlas.sizeTexels.x, i / atlas.sizeTexels.x})))
            map[i] = renewed[i];
}

}  // namespace

void LiveEngine::finishArea(const ChartSet& charts, Progress& progress) {
    const Clock::time_point start = Clock::now();
    const GatherInput input = state_.input();
    mix(state_.areaMap,
        filterAreaIrradiance(state_.areaEstimates, input.atlas, input.points, input.irradianceTexels, charts),
        charts, input.atlas);
    if (publish(state_, state_.phatexture.areaIrradiance,
                finishAreaIrradiance(state_.areaMap, input, state_.seams, progress))) {
        ++state_.areaVersion;
        ++state_.irradianceVersion;
    }
    ++plan_;
    forgetMoved(LiveTask::areaLight);
    if (charts.empty()) {
        areaDirty_ = false;
        areaWork_ = 0;
        areaMapScene_ = state_.scene.version();
    }
    count(stats_.areaMaps, mapWork(kAreaMapWork, charts), secondsSince(start));
}

void LiveEngine::finishIndirect(const ChartSet& charts, Progress& progress) {
    const Clock::time_point start = Clock::now();
    std::atomic<uint64_t> rays = 0;
    const GatherInput input = state_.input();
    const Phatexture& now = state_.phatexture;
    mix(state_.indirectMap,
        charts.empty()
            ? irradianceFromNodes(input, now.areaIrradiance, state_.settings, state_.level, state_.nodes,
                                  progress, nullptr, rays)
            : irradianceOfCharts(input, now.areaIrradiance, now.indirectIrradiance, state_.settings,
                                 state_.level, state_.nodes, charts, progress, rays),
        charts, input.atlas);
    if (publish(state_, state_.phatexture.indirectIrradiance,
                finishIndirectIrradiance(state_.indirectMap, input, state_.seams, progress)))
        ++state_.irradianceVersion;
    ++plan_;
    forgetMoved(LiveTask::nodes);
    if (charts.empty()) {
        indirectDirty_ = false;
        nodeWork_ = 0;
        indirectMapScene_ = state_.scene.version();
    }
    count(stats_.indirectMaps, rays + mapWork(kIndirectMapWork, charts), secondsSince(start));
}

void LiveEngine::forgetMoved(LiveTask task) {
    queues_[size_t(task)].movedWork = 0;
    queues_[size_t(task)].movedDone = false;
}

void LiveEngine::count(LiveStats::Task& task, uint64_t work, double seconds) {
    clock_ += work;
    task.items += 1;
    task.work += work;
    task.seconds += seconds;
}

LiveUpdate LiveEngine::takeUpdate() {
    LiveUpdate update = collectUpdate(state_);
    const Atlas& atlas = state_.scene.atlas();
    tileLightStale_ |= !update.phatexels.empty();
    if (tileLightStale_ && (clock_ >= tileLightClock_ || settled())) {
        update.tileLight = tileLight(state_.scene.scene(), atlas, state_.phatexture);
        tileLightStale_ = false;
        tileLightClock_ = clock_ + kTileLightWork * atlas.texelCount();
    }
    return update;
}

LiveShare LiveEngine::renewed() const {
    const uint64_t version = state_.scene.version();
    const auto shareOf = [](const auto& items, const auto& isNew) {
        const auto count = std::count_if(items.begin(), items.end(), isNew);
        return items.empty() ? 1.0f : float(double(count) / double(items.size()));
    };
    const auto present = [&](uint64_t scene) { return scene == version; };
    LiveShare share;
    uint64_t tiles = 0, heard = 0;
    for (size_t tile = 0; tile < state_.tileScene.size(); ++tile) {
        if (state_.scene.atlas().tileChart[tile] == kNoChart) continue;
        ++tiles;
        heard += state_.tileScene[tile] == version;
    }
    const auto of = [&](LiveTask task) -> float& { return share[size_t(task)]; };
    of(LiveTask::respond) = float(double(heard) / double(std::max<uint64_t>(tiles, 1)));
    of(LiveTask::photons) = shareOf(state_.photonsScene, present);
    of(LiveTask::areaLight) = shareOf(state_.regionScene, present);
    of(LiveTask::nodes) = shareOf(state_.nodeAge, [&](const NodeAge& age) {
        return age.scene == version && age.area == state_.areaVersion;
    });
    of(LiveTask::blocks) = shareOf(state_.blockAge, [&](const BlockAge& age) {
        return age.scene == version && age.photons == version && age.irradiance == state_.irradianceVersion;
    });
    return share;
}

}  // namespace phat
