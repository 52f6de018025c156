#include "core/dynamic/incremental_baker.h"

#include <cassert>

#include "core/base/stopwatch.h"

namespace phat {
namespace {

constexpr uint64_t kPassStream = 0x4ef1;

/// Stops when another does, and reports nothing: slices are too small to be stages.
class OnlyStop : public SilentProgress {
  public:
    explicit OnlyStop(const Progress& of) : of_(of) {}
    bool stopRequested() const override { return of_.stopRequested(); }

  private:
    const Progress& of_;
};

}  // namespace

IncrementalBaker::IncrementalBaker(SharedSnapshot rest, const Atlas& atlas, const TexelPoints& points,
                                   const Phatexture& baked, const BakeSettings& settings)
    : state_(std::move(rest), atlas, points, baked, settings),
      seed_(settings.seed),
      photonSeed_(settings.photons.seed),
      maps_(state_),
      moved_(state_, maps_),
      phatexels_(state_) {}

void IncrementalBaker::setSeeds() {
    const uint32_t pass = state_.pass;
    state_.settings.seed = pass == 0 ? seed_ : hashOf(seed_, kPassStream, pass);
    state_.settings.photons.seed = pass == 0 ? photonSeed_ : hashOf(photonSeed_, kPassStream, pass);
}

void IncrementalBaker::refine() {
    assert(converged());
    maps_.beginPass();
    ++state_.pass;
    setSeeds();
    state_.scene.beginVersion();
    // Nothing has moved, so there is nothing to retrace.
    state_.tileScene.assign(state_.tileScene.size(), state_.scene.version());
    ++state_.revision;
}

bool IncrementalBaker::setScene(SharedSnapshot snapshot) {
    if (!state_.scene.set(std::move(snapshot))) return false;
    state_.pass = 0;
    setSeeds();
    state_.updateSceneQueries();
    const uint64_t version = state_.scene.version();
    for (size_t tile = 0; tile < state_.tileDirty.size(); ++tile) {
        const uint32_t chart = state_.scene.atlas().tileChart[tile];
        if (chart != kNoChart && state_.scene.movedAt(chart) == version) packTile(state_, tile);
    }
    ++state_.revision;
    scheduler_.noteChange(state_.clock);
    return true;
}

UnqueuedWork IncrementalBaker::unqueuedWork() const {
    return {.moved = moved_.hasWork(),
            .maps = maps_.isRunning(),
            .areaMapStale = maps_.areaIsStale(),
            .indirectMapStale = maps_.indirectIsStale()};
}

bool IncrementalBaker::converged() const {
    // Queues that are not current: something has become stale.
    if (!scheduler_.isCurrent(state_)) return false;
    const UnqueuedWork other = unqueuedWork();
    if (other.areaMapStale || other.indirectMapStale) return false;
    for (size_t t = 0; t < kBakerTasks; ++t)
        if (scheduler_.hasWork(BakerTask(t), other)) return false;
    return true;
}

void IncrementalBaker::replan() {
    maps_.adaptNodes();
    scheduler_.replan(state_, unqueuedWork());
}

uint64_t IncrementalBaker::advance(uint64_t work, const Progress& whole) {
    OnlyStop progress(whole);
    const uint64_t start = state_.clock;
    workBudget_ += int64_t(work);
    replan();
    while (workBudget_ > 0) {
        progress.throwIfStopped();
        const uint64_t before = state_.clock;
        const UnqueuedWork other = unqueuedWork();
        maps_.beginDue(!scheduler_.hasWork(BakerTask::areaLight, other),
                       !scheduler_.hasWork(BakerTask::nodes, other));
        const std::optional<BakerTask> task = scheduler_.takeTask(unqueuedWork());
        if (!task) {
            workBudget_ = 0;
            break;
        }
        runSlice(*task, progress);
        workBudget_ -= int64_t(state_.clock - before);
        replan();
    }
    return state_.clock - start;
}

uint64_t IncrementalBaker::advanceMaps() {
    const Stopwatch start;
    const MapUpdater::Slice slice = maps_.advance();
    BakerStats::Task& stats = slice.kind == MapKind::area ? stats_.areaMaps : stats_.indirectMaps;
    stats.items += slice.finished;
    stats.work += slice.work;
    stats.seconds += start.seconds();
    return slice.work;
}

uint64_t IncrementalBaker::runItems(BakerTask task, std::span<const uint32_t> items, Progress& progress) {
    switch (task) {
        case BakerTask::moved:
            return moved_.advance();
        case BakerTask::retraceInvalidated:
            return phatexels_.retraceInvalidated(items);
        case BakerTask::photons:
            return phatexels_.tracePhotonPart(items.front(), progress);
        case BakerTask::areaLight:
            return maps_.estimateRegions(items);
        case BakerTask::nodes:
            return maps_.traceNodes(items);
        case BakerTask::maps:
            return advanceMaps();
        case BakerTask::blocks:
            return phatexels_.updateBlocks(items);
    }
    return 0;
}

void IncrementalBaker::runSlice(BakerTask task, Progress& progress) {
    const Stopwatch start;
    const std::span<const uint32_t> items = scheduler_.takeItems(task);
    const uint64_t work = runItems(task, items, progress);
    // Whether items are stale may depend on all items of a kind being up to date.
    if (!items.empty() && !scheduler_.hasWork(task, {})) ++state_.revision;
    state_.clock += work;
    scheduler_.charge(task, work, state_.clock);
    BakerStats::Task& stats = stats_.tasks[size_t(task)];
    stats.items = task == BakerTask::moved ? moved_.rounds() : stats.items + items.size();
    stats.work += work;
    stats.seconds += start.seconds();
    stats_.phatexels = phatexels_.updated();
}

uint64_t IncrementalBaker::converge(const Progress& progress) {
    constexpr uint64_t kWorkAtOnce = 20'000;
    uint64_t work = 0;
    while (!converged()) work += advance(kWorkAtOnce, progress);
    return work;
}

LightUpdate IncrementalBaker::drainUpdate() {
    LightUpdate update = collectUpdate(state_);
    update.refined = state_.pass > 0;
    tileLight_.addTo(update, state_, converged());
    return update;
}

UpToDateFractions IncrementalBaker::upToDate() const {
    const uint64_t version = state_.scene.version();
    const auto shareOf = [](const auto& items, const auto& isNew) {
        const auto count = std::count_if(items.begin(), items.end(), isNew);
        return items.empty() ? 1.0f : float(double(count) / double(items.size()));
    };
    const auto present = [&](uint64_t scene) { return scene == version; };
    UpToDateFractions fractions;
    uint64_t tiles = 0, updated = 0;
    for (size_t tile = 0; tile < state_.tileScene.size(); ++tile) {
        if (state_.scene.atlas().tileChart[tile] == kNoChart) continue;
        ++tiles;
        updated += state_.tileScene[tile] == version;
    }
    const auto of = [&](BakerTask task) -> float& { return fractions[size_t(task)]; };
    of(BakerTask::moved) = moved_.hasWork() ? 0.0f : 1.0f;
    of(BakerTask::retraceInvalidated) = float(double(updated) / double(std::max<uint64_t>(tiles, 1)));
    of(BakerTask::photons) = shareOf(state_.photonsScene, present);
    of(BakerTask::areaLight) = shareOf(state_.regionScene, present);
    of(BakerTask::nodes) = shareOf(state_.nodeAge, [&](const NodeAge& age) {
        return age.scene == version && age.area == state_.areaVersion;
    });
    of(BakerTask::maps) = maps_.areaIsStale() || maps_.indirectIsStale() ? 0.0f : 1.0f;
    of(BakerTask::blocks) = shareOf(state_.blockAge, [&](const BlockAge& age) {
        return age.scene == version && age.photons == version && age.irradiance == state_.irradianceVersion;
    });
    return fractions;
}

}  // namespace phat
