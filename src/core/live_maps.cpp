// Irradiance maps of the live engine: when they are made anew, and how.

#include <chrono>

#include "core/indirect_irradiance.h"
#include "core/irradiance_finish.h"
#include "core/live_engine.h"

namespace phat {
namespace {

// In rays: a texel of the area lights' map and of the indirect one, in all.
constexpr uint64_t kAreaMapWork = 2, kIndirectMapWork = 6;
// Maps are made anew when the work on what they are made from outweighs them so many times.
constexpr uint64_t kMapShare = 3;
// So many texels are stitched and packed in the time of a ray.
constexpr uint64_t kTexelsStitchedAWork = 8;
// A piece of a map: some ten milliseconds of a core.
constexpr uint64_t kMapPieceWork = 30'000;

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

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

void LiveEngine::beginDueMap() {
    // What has moved is few texels, and seen to be wrong at once.
    if (movedIsDue(LiveTask::areaLight))
        beginMap(true, movedSince(areaMapScene_));
    else if (movedIsDue(LiveTask::nodes) && allNodesKnown(state_))
        beginMap(false, movedSince(indirectMapScene_));
    else if (areaIsDue())
        beginMap(true, {});
    else if (indirectIsDue())
        beginMap(false, {});
}

void LiveEngine::beginMap(bool area, ChartSet charts) {
    MapJob& job = job_.emplace();
    job.area = area;
    job.charts = std::move(charts);
    const GatherInput input = state_.input();
    const Phatexture& now = state_.phatexture;
    if (area)
        job.pieces.emplace(filterAreaIrradiance(state_.areaEstimates, input.atlas, input.points,
                                                input.irradianceTexels, job.charts, job.map, kMapPieceWork));
    else if (job.charts.empty())
        job.pieces.emplace(irradianceFromNodes(input, now.areaIrradiance, state_.settings, state_.level,
                                               state_.nodes, job.map, kMapPieceWork, job.progress, nullptr,
                                               job.rays));
    else
        job.pieces.emplace(irradianceOfCharts(input, now.areaIrradiance, now.indirectIrradiance,
                                              state_.settings, state_.level, state_.nodes, job.charts,
                                              job.map, kMapPieceWork, job.progress, job.rays));
    forgetMoved(area ? LiveTask::areaLight : LiveTask::nodes);
    // What becomes known from now on is for the next map.
    if (job.charts.empty()) {
        (area ? areaDirty_ : indirectDirty_) = false;
        (area ? areaWork_ : nodeWork_) = 0;
        (area ? areaMapScene_ : indirectMapScene_) = state_.scene.version();
    }
    // At once, because it reads the nodes, whose number may change.
    advanceMap();
}

void LiveEngine::advanceMap() {
    const Clock::time_point start = Clock::now();
    const bool area = job_->area, more = job_->pieces->next();
    const uint64_t work = more ? job_->pieces->work() : state_.scene.atlas().texelCount() / kTexelsStitchedAWork;
    if (!more) publishMap();
    countMap(area, work, secondsSince(start));
    shares_.done(LiveTask::maps, work);
}

void LiveEngine::publishMap() {
    const MapJob& job = *job_;
    const GatherInput input = state_.input();
    Phatexture& now = state_.phatexture;
    mix(job.area ? state_.areaMap : state_.indirectMap, std::move(job_->map), job.charts, input.atlas);
    const bool changed =
        job.area ? publish(state_, now.areaIrradiance,
                           finishAreaIrradiance(state_.areaMap, input, state_.seams, job.progress))
                 : publish(state_, now.indirectIrradiance,
                           finishIndirectIrradiance(state_.indirectMap, input, state_.seams, job.progress));
    if (changed && job.area) ++state_.areaVersion;
    state_.irradianceVersion += changed;
    ++plan_;
    ++(job.area ? stats_.areaMaps : stats_.indirectMaps).items;
    job_.reset();
}

void LiveEngine::forgetMoved(LiveTask task) {
    queues_[size_t(task)].movedWork = 0;
    queues_[size_t(task)].movedDone = false;
}

void LiveEngine::countMap(bool area, uint64_t work, double seconds) {
    clock_ += work;
    LiveStats::Task& task = area ? stats_.areaMaps : stats_.indirectMaps;
    task.work += work;
    task.seconds += seconds;
}

}  // namespace phat
