#include "core/dynamic/incremental_baker.h"

#include "core/base/stopwatch.h"
#include "core/phatexel/radiance_bound.h"
#include "core/scene/light_bound.h"

namespace phat {
namespace {

// A pass over everything, in rays a texel: by its age an item's urgency grows by 1 in that time.
constexpr uint64_t kPassWork = 64;

// Tiles' brightest light is looked for anew after so much work, in rays a texel.
constexpr uint64_t kTileLightWork = 1;

constexpr uint64_t kPassStream = 0x4ef1;

// Changes that are no farther apart are one motion, in rays a texel.
constexpr uint64_t kStillWork = 32;

// A piece of work: some ten milliseconds, and enough for many threads.
constexpr size_t kNodesPerSlice = 1024;

/// Stops when another does, and reports nothing: pieces are too small to be stages.
class OnlyStop : public SilentProgress {
  public:
    explicit OnlyStop(const Progress& of) : of_(of) {}
    bool stopRequested() const override { return of_.stopRequested(); }

  private:
    const Progress& of_;
};

}  // namespace

IncrementalBaker::IncrementalBaker(const Scene& rest, const Atlas& atlas, const TexelPoints& points,
                                   const Phatexture& baked, const BakeSettings& settings)
    : state_(rest, atlas, points, baked, settings), seed_(settings.seed), photonSeed_(settings.photons.seed) {
    adaptNodes(state_);
    indirectDirty_ = true;
}

void IncrementalBaker::setSeeds() {
    const uint32_t pass = state_.pass;
    state_.settings.seed = pass == 0 ? seed_ : hashOf(seed_, kPassStream, pass);
    state_.settings.photons.seed = pass == 0 ? photonSeed_ : hashOf(photonSeed_, kPassStream, pass);
}

void IncrementalBaker::refine() {
    if (state_.pass == 0) {
        state_.areaMean = state_.areaMap;
        state_.indirectMean = state_.indirectMap;
    } else {
        state_.areaMean = meanMap(state_.areaMean, state_.areaMap, state_.pass);
        state_.indirectMean = meanMap(state_.indirectMean, state_.indirectMap, state_.pass);
    }
    ++state_.pass;
    setSeeds();
    state_.scene.renew();
    // Nothing has moved, so they have nothing to hear of.
    state_.tileScene.assign(state_.tileScene.size(), state_.scene.version());
    ++queueVersion_;
}

bool IncrementalBaker::setSceneState(const SceneState& state) {
    if (!state_.scene.set(state)) return false;
    state_.pass = 0;
    setSeeds();
    state_.rebuildRays();
    const uint64_t version = state_.scene.version();
    for (size_t tile = 0; tile < state_.tileDirty.size(); ++tile) {
        const uint32_t chart = state_.scene.atlas().tileChart[tile];
        if (chart != kNoChart && state_.scene.movedAt(chart) == version) packPlace(state_, tile);
    }
    ++queueVersion_;
    changes_ = {std::max<uint64_t>(clock_, 1), changes_[0]};
    return true;
}

void IncrementalBaker::setEye(const Camera* eye) {
    eye_ = eye ? std::optional<Camera>(*eye) : std::nullopt;
    valuesFor_ = 0;
}

bool IncrementalBaker::hasWork(BakerTask task) {
    if (task == BakerTask::moved) return moved_.step != MovedLight::Step::none || anyMoved();
    if (task == BakerTask::maps) return areaJob_ || indirectJob_;
    Queue& queue = queues_[size_t(task)];
    if (queue.planned == queueVersion_ && queue.next < queue.items.size()) return true;
    if (queue.planned != queueVersion_) {
        if (valuesFor_ != state_.scene.version()) {
            tileValue_ = tileValues(state_, eye_ ? &*eye_ : nullptr);
            valuesFor_ = state_.scene.version();
        }
        if (task == BakerTask::nodes) adaptNodes(state_);
        if (task == BakerTask::blocks) state_.irradianceKnown = areaIsKnown() && indirectIsKnown();
        queue.items =
            urgentFirst(state_, task, tileValue_, clock_, kPassWork * state_.scene.atlas().texelCount());
        queue.next = 0;
        queue.planned = queueVersion_;
    }
    return queue.next < queue.items.size();
}

std::span<const uint32_t> IncrementalBaker::takeItems(BakerTask task, size_t most) {
    Queue& queue = queues_[size_t(task)];
    const size_t first = queue.next;
    queue.next = std::min(first + most, queue.items.size());
    return std::span(queue.items).subspan(first, queue.next - first);
}

bool IncrementalBaker::converged() {
    if (areaDirty_ || indirectDirty_) return false;
    for (size_t t = 0; t < kBakerTasks; ++t)
        if (hasWork(BakerTask(t))) return false;
    return true;
}

bool IncrementalBaker::keepsChanging() const {
    const uint64_t still = kStillWork * state_.scene.atlas().texelCount();
    return clock_ - changes_[0] < still && changes_[1] > 0 && changes_[0] - changes_[1] < still;
}

bool IncrementalBaker::waits(BakerTask task) {
    if ((task != BakerTask::nodes && task != BakerTask::blocks) || keepsChanging()) return false;
    if (task == BakerTask::nodes) return !areaIsKnown();
    return !areaIsKnown() || !indirectIsKnown() || hasWork(BakerTask::photons);
}

uint64_t IncrementalBaker::advance(uint64_t work, const Progress& whole) {
    OnlyStop progress(whole);
    const uint64_t start = clock_;
    workBudget_ += int64_t(work);
    while (workBudget_ > 0) {
        progress.throwIfStopped();
        const uint64_t before = clock_;
        beginDueMaps();
        std::array<bool, kBakerTasks> busy{};
        for (size_t t = 0; t < kBakerTasks; ++t) {
            busy[t] = hasWork(BakerTask(t)) && !waits(BakerTask(t));
        }
        const std::optional<BakerTask> task = shares_.next(busy);
        if (!task) {
            workBudget_ = 0;
            break;
        }
        runSlice(*task, progress);
        workBudget_ -= int64_t(clock_ - before);
    }
    return clock_ - start;
}

void IncrementalBaker::runSlice(BakerTask task, Progress& progress) {
    const Stopwatch start;
    Queue& queue = queues_[size_t(task)];
    const size_t before = queue.next;
    uint64_t work = 0;
    switch (task) {
        case BakerTask::moved:
            work = updateMoved();
            break;
        case BakerTask::retraceInvalidated:
            work = retraceInvalidated();
            break;
        case BakerTask::photons:
            work = tracePhotonPart(progress);
            break;
        case BakerTask::areaLight:
            work = updateRegions();
            break;
        case BakerTask::nodes:
            work = traceNodes(takeItems(BakerTask::nodes, kNodesPerSlice));
            break;
        case BakerTask::blocks:
            work = updateBlocks();
            break;
        case BakerTask::maps:
            work = advanceWholeMaps();
            break;
    }
    // What is stale may depend on all of a kind being known.
    if (queue.next > before && queue.next == queue.items.size()) ++queueVersion_;
    clock_ += work;
    shares_.done(task, work);
    BakerStats::Task& stats = stats_.tasks[size_t(task)];
    stats.items += queue.next - before;
    stats.work += work;
    stats.seconds += start.seconds();
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
    const Atlas& atlas = state_.scene.atlas();
    const uint64_t version = state_.scene.version();
    tileLightStale_ |= !update.phatexels.empty();
    const bool due = tileLightStale_ && (clock_ >= tileLightClock_ || converged());
    if (due || tileLight_.empty()) {
        tileLight_ = tileLight(state_.scene.scene(), atlas, state_.phatexture);
        tileLightStale_ = false;
        tileLightClock_ = clock_ + kTileLightWork * atlas.texelCount();
    }
    if (due || tileLightScene_ != version) {
        tileLightScene_ = version;
        update.tileLight = tileLight_;
        // Irradiance is renewed before PHATexels are: what they saw of an older scene must not bound it.
        for (size_t tile = 0; tile < tileLight_.size(); ++tile)
            if (atlas.tileChart[tile] != kNoChart &&
                state_.blockAge[atlas.blockAt(state_.cornerOfTile(tile))].scene != version)
                update.tileLight[tile] = glm::vec4(glm::vec3(kUnbounded), tileLight_[tile].a);
    }
    return update;
}

UpToDateShares IncrementalBaker::upToDate() const {
    const uint64_t version = state_.scene.version();
    const auto shareOf = [](const auto& items, const auto& isNew) {
        const auto count = std::count_if(items.begin(), items.end(), isNew);
        return items.empty() ? 1.0f : float(double(count) / double(items.size()));
    };
    const auto present = [&](uint64_t scene) { return scene == version; };
    UpToDateShares share;
    uint64_t tiles = 0, heard = 0;
    for (size_t tile = 0; tile < state_.tileScene.size(); ++tile) {
        if (state_.scene.atlas().tileChart[tile] == kNoChart) continue;
        ++tiles;
        heard += state_.tileScene[tile] == version;
    }
    const auto of = [&](BakerTask task) -> float& { return share[size_t(task)]; };
    of(BakerTask::moved) = moved_.step != MovedLight::Step::none || anyMoved() ? 0.0f : 1.0f;
    of(BakerTask::retraceInvalidated) = float(double(heard) / double(std::max<uint64_t>(tiles, 1)));
    of(BakerTask::photons) = shareOf(state_.photonsScene, present);
    of(BakerTask::areaLight) = shareOf(state_.regionScene, present);
    of(BakerTask::nodes) = shareOf(state_.nodeAge, [&](const NodeAge& age) {
        return age.scene == version && age.area == state_.areaVersion;
    });
    of(BakerTask::maps) = areaJob_ || indirectJob_ || areaDirty_ || indirectDirty_ ? 0.0f : 1.0f;
    of(BakerTask::blocks) = shareOf(state_.blockAge, [&](const BlockAge& age) {
        return age.scene == version && age.photons == version && age.irradiance == state_.irradianceVersion;
    });
    return share;
}

}  // namespace phat
