// Irradiance maps of the incremental baker: when they are made anew, and how.

#include "core/bake/indirect_irradiance.h"
#include "core/bake/irradiance_finish.h"
#include "core/base/stopwatch.h"
#include "core/dynamic/incremental_baker.h"

namespace phat {
namespace {

// In rays: a texel of the area lights' map and of the indirect one, in all.
constexpr uint64_t kAreaMapWork = 2, kIndirectMapWork = 6;
// Maps are made anew when the work on what they are made from outweighs them so many times.
constexpr uint64_t kMapShare = 3;
// So many texels are stitched and packed in the time of a ray.
constexpr uint64_t kTexelsStitchedPerRay = 8;
// A piece of a map: some ten milliseconds of a core.
constexpr uint64_t kMapSliceWork = 30'000;

/// Takes what is `wanted` of a renewed map: wanted(chart).
template <typename Value, typename Wanted>
void mix(std::vector<Value>& map, const std::vector<Value>& renewed, const Atlas& atlas,
         const Wanted& wanted) {
    for (size_t i = 0; i < map.size(); ++i)
        if (wanted(atlas.chartAt(i))) map[i] = renewed[i];
}

}  // namespace

bool IncrementalBaker::areaIsDue() {
    if (!areaDirty_) return false;
    if (state_.pass > 0) return !hasWork(BakerTask::areaLight);
    return !hasWork(BakerTask::areaLight) ||
           areaWork_ > kMapShare * kAreaMapWork * state_.scene.atlas().texelCount();
}

bool IncrementalBaker::indirectIsDue() {
    if (!indirectDirty_) return false;
    const bool all = !hasWork(BakerTask::nodes);
    if (!all && nodeWork_ <= kMapShare * kIndirectMapWork * state_.scene.atlas().texelCount()) return false;
    return allNodesKnown(state_);
}

void IncrementalBaker::beginDueMaps() {
    if (!areaJob_ && areaIsDue()) {
        areaDirty_ = false;  // what becomes known from now on is for the next map
        areaWork_ = 0;
        beginMap(areaJob_, true, {});
    }
    if (!indirectJob_ && indirectIsDue()) {
        indirectDirty_ = false;
        nodeWork_ = 0;
        beginMap(indirectJob_, false, {});
    }
}

void IncrementalBaker::beginMap(std::optional<MapJob>& slot, bool area, ChartSet charts) {
    MapJob& job = slot.emplace();
    job.area = area;
    job.charts = std::move(charts);
    const GatherInput input = state_.input();
    const Phatexture& now = state_.phatexture;
    const GatherContext context{input, state_.settings, job.progress, nullptr, job.rays, kMapSliceWork};
    if (area)
        job.pieces.emplace(filterAreaIrradiance(state_.areaEstimates,
                                                {input.atlas, input.points, input.irradianceTexels},
                                                job.charts, job.map, kMapSliceWork));
    else if (job.charts.empty())
        job.pieces.emplace(
            irradianceFromNodes(context, now.areaIrradiance, state_.level, state_.nodes, job.map));
    else
        job.pieces.emplace(irradianceOfCharts(context, {now.indirectIrradiance, now.areaIrradiance},
                                              state_.level, state_.nodes, job.charts, job.map));
}

uint64_t IncrementalBaker::advanceMap(std::optional<MapJob>& slot) {
    const uint64_t raysBefore = slot->rays, texels = state_.scene.atlas().texelCount();
    if (!slot->pieces->next()) {
        publishMap(*slot);
        slot.reset();
        return texels / kTexelsStitchedPerRay;
    }
    // A piece passes over the other charts' texels in next to no time.
    const uint64_t rays = slot->rays - raysBefore,
                   rest = slot->pieces->work() - std::min(rays, slot->pieces->work());
    return rays + rest * texelsOf(slot->charts) / texels;
}

uint64_t IncrementalBaker::texelsOf(const ChartSet& charts) const {
    const Atlas& atlas = state_.scene.atlas();
    if (charts.empty()) return atlas.texelCount();
    uint64_t texels = 0;
    for (uint32_t c = 0; c < charts.size(); ++c)
        if (hasChart(charts, c))
            texels += uint64_t(atlas.charts[c].sizeTexels().x) * atlas.charts[c].sizeTexels().y;
    return texels;
}

uint64_t IncrementalBaker::advanceWholeMaps() {
    const Stopwatch start;
    // Light straight from lamps is more, and sooner done.
    std::optional<MapJob>& job = areaJob_ ? areaJob_ : indirectJob_;
    BakerStats::Task& stats = job->area ? stats_.areaMaps : stats_.indirectMaps;
    const uint64_t work = advanceMap(job);
    stats.items += !job;
    stats.work += work;
    stats.seconds += start.seconds();
    return work;
}

void IncrementalBaker::publishMap(MapJob& job) {
    const GatherInput input = state_.input();
    std::vector<uint32_t>& shown =
        job.area ? state_.phatexture.areaIrradiance : state_.phatexture.indirectIrradiance;
    IrradianceMap& map = job.area ? state_.areaMap : state_.indirectMap;
    const bool whole = job.charts.empty();
    mix(map, job.map, input.atlas, [&](uint32_t chart) {
        return whole ? job.newer.empty() || !hasChart(job.newer, chart) : hasChart(job.charts, chart);
    });
    // A thing's charts have seams with each other alone.
    std::vector<SeamPoint> seams;
    for (const SeamPoint& point : state_.seams)
        if (hasChart(job.charts, point.chart[0])) seams.push_back(point);
    const IrradianceMap& before = job.area ? state_.areaMean : state_.indirectMean;
    IrradianceMap seen = state_.pass > 0 ? meanMap(before, map, state_.pass) : map;
    std::vector<uint32_t> renewed =
        job.area ? finishAreaIrradiance(std::move(seen), input, seams, job.progress)
                 : finishIndirectIrradiance(std::move(seen), input, seams, job.progress);
    if (!whole)
        mix(renewed, shown, input.atlas, [&](uint32_t chart) { return !hasChart(job.charts, chart); });
    const bool changed = publish(state_, shown, std::move(renewed));
    if (changed && job.area) ++state_.areaVersion;
    state_.irradianceVersion += changed;
    ++queueVersion_;
    std::optional<MapJob>& ofAll = job.area ? areaJob_ : indirectJob_;
    if (!whole && ofAll) {
        ofAll->newer.resize(job.charts.size(), 0);
        for (size_t c = 0; c < job.charts.size(); ++c) ofAll->newer[c] |= job.charts[c];
    }
    // Those were mapped without the rest of it.
    if (whole && !job.newer.empty()) (job.area ? areaDirty_ : indirectDirty_) = true;
}

}  // namespace phat
