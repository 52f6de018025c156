#include "core/dynamic/map_updater.h"

#include <cassert>
#include <numeric>

#include "core/bake/indirect_irradiance.h"
#include "core/bake/irradiance_finish.h"
#include "core/bake/irradiance_ray.h"
#include "core/base/parallel.h"

namespace phat {
namespace {

// In rays: a texel of the area lights' map and of the indirect one, in all.
constexpr uint64_t kAreaMapWork = 2, kIndirectMapWork = 6;
// A map is updated when the work on its inputs exceeds its own by this factor.
constexpr uint64_t kMapWorkRatio = 3;
// Texels that are stitched and packed in the time of a ray.
constexpr uint64_t kTexelsStitchedPerRay = 8;
// A slice of a map: some ten milliseconds of a core.
constexpr uint64_t kMapSliceWork = 30'000;

/// Copies the charts for which selects(chart) holds from `updated`.
template <typename Value, typename Selects>
void mix(std::vector<Value>& map, const std::vector<Value>& updated, const Atlas& atlas,
         const Selects& selects) {
    for (size_t i = 0; i < map.size(); ++i)
        if (selects(atlas.chartAt(i))) map[i] = updated[i];
}

/// Mean of `passes` maps, whose own mean is `mean`, and one more.
IrradianceMap meanMap(const IrradianceMap& mean, const IrradianceMap& map, uint32_t passes) {
    IrradianceMap next = mean;
    for (size_t i = 0; i < next.size(); ++i) next[i] += (map[i] - next[i]) / float(passes + 1);
    return next;
}

}  // namespace

MapUpdater::MapUpdater(BakerState& state)
    : state_(state), seams_(findSeams(state.scene.scene(), state.scene.atlas())) {
    const Phatexture& baked = state_.phatexture;
    for (const uint32_t packed : baked.areaIrradiance) areaMap_.push_back(unpackRgb9e5(packed));
    for (const uint32_t packed : baked.indirectIrradiance) indirectMap_.push_back(unpackRgb9e5(packed));
    if (state_.hasArea) {
        // Until a texel has an estimate of its own, the baked value is used.
        areaEstimates_.resize(areaMap_.size());
        for (size_t i = 0; i < areaMap_.size(); ++i) areaEstimates_[i].value = areaMap_[i];
    }
    adaptNodes();
}

uint64_t MapUpdater::estimateArea(std::span<const BlockRect> blocks) {
    std::vector<uint64_t> rays(blocks.size(), 0);
    const GatherInput input = state_.input();
    SilentProgress silent;
    parallelRanges(blocks.size(), 1, silent, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            updateAreaIrradiance(input, state_.settings, blocks[i].origin, blocks[i].size, areaEstimates_,
                                 rays[i]);
    });
    areaDirty_ = true;
    const uint64_t work = std::accumulate(rays.begin(), rays.end(), uint64_t(0));
    areaWork_ += work;
    return work;
}

uint64_t MapUpdater::estimateRegions(std::span<const uint32_t> regions) {
    const Atlas& atlas = state_.scene.atlas();
    const uint32_t wide = (atlas.sizeTexels.x + kBlockSize - 1) / kBlockSize;
    std::vector<BlockRect> blocks;
    for (const uint32_t region : regions) {
        const glm::uvec2 corner = glm::uvec2(region % wide, region / wide) * kBlockSize;
        blocks.push_back({corner, glm::min(glm::uvec2(kBlockSize), atlas.sizeTexels - corner)});
        state_.regionScene[region] = state_.scene.version();
        state_.regionClock[region] = state_.clock;
    }
    return estimateArea(blocks);
}

void MapUpdater::adaptNodes() {
    if (state_.levelTexelsVersion == state_.scene.texelsVersion()) return;
    const uint32_t width = state_.scene.atlas().sizeTexels.x;
    IrradianceLevel level = coarseLevel(state_.input());
    std::vector<NodeRays> nodes(level.texel.size());
    std::vector<NodeAge> ages(nodes.size());
    for (size_t n = 0; n < nodes.size() && !state_.level.node.empty(); ++n) {
        uint32_t before = state_.level.node[level.groupOf(level.texel[n], width)];
        while (before != kNoNode && state_.level.texel[before] != level.texel[n])
            before = state_.level.next[before];
        if (before == kNoNode) continue;
        nodes[n] = state_.nodes[before];
        ages[n] = state_.nodeAge[before];
        // Rays that end in texels that are occluded now are invalid until they are traced again.
        for (uint32_t i = 0; i < nodes[n].count; ++i) {
            uint32_t& texel = nodes[n].texel[i];
            if (texel != kNoTexel && level.node[level.groupOf(texel, width)] == kNoNode) texel = kNoTexel;
        }
    }
    state_.level = std::move(level);
    state_.nodes = std::move(nodes);
    state_.nodeAge = std::move(ages);
    state_.levelTexelsVersion = state_.scene.texelsVersion();
}

uint64_t MapUpdater::traceNodes(std::span<const uint32_t> nodes) {
    std::vector<uint64_t> rays(nodes.size(), 0);
    const GatherInput input = state_.input();
    SilentProgress silent;
    parallelRanges(nodes.size(), 32, silent, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            state_.nodes[nodes[i]] = traceNode(input, state_.phatexture.areaIrradiance, state_.settings,
                                               state_.level, nodes[i], rays[i]);
    });
    for (const uint32_t node : nodes)
        state_.nodeAge[node] = {state_.scene.version(), state_.areaVersion, state_.clock};
    indirectDirty_ = true;
    const uint64_t work = std::accumulate(rays.begin(), rays.end(), uint64_t(0));
    nodeWork_ += work;
    return work;
}

bool MapUpdater::areaIsDue(bool allEstimated) const {
    if (!areaDirty_ || allEstimated) return areaDirty_;
    return state_.pass == 0 && areaWork_ > kMapWorkRatio * kAreaMapWork * state_.scene.atlas().texelCount();
}

bool MapUpdater::indirectIsDue(bool allTraced) const {
    if (!indirectDirty_) return false;
    if (!allTraced && nodeWork_ <= kMapWorkRatio * kIndirectMapWork * state_.scene.atlas().texelCount())
        return false;
    return std::all_of(state_.nodeAge.begin(), state_.nodeAge.end(),
                       [](const NodeAge& age) { return age.scene != 0; });
}

void MapUpdater::beginDue(bool allEstimated, bool allTraced) {
    if (!areaJob_ && areaIsDue(allEstimated)) {
        areaDirty_ = false;  // what becomes known from now on is for the next map
        areaWork_ = 0;
        begin(areaJob_, MapKind::area, {});
    }
    if (!indirectJob_ && indirectIsDue(allTraced)) {
        indirectDirty_ = false;
        nodeWork_ = 0;
        begin(indirectJob_, MapKind::indirect, {});
    }
}

void MapUpdater::begin(std::optional<MapJob>& slot, MapKind kind, ChartSet charts) {
    MapJob& job = slot.emplace();
    job.kind = kind;
    job.charts = std::move(charts);
    const GatherInput input = state_.input();
    const Phatexture& now = state_.phatexture;
    const GatherContext context{input, state_.settings, job.progress, nullptr, job.rays, kMapSliceWork};
    if (kind == MapKind::area)
        job.slices.emplace(
            filterAreaIrradiance(areaEstimates_, input.receivers(), job.charts, job.map, kMapSliceWork));
    else if (job.charts.empty())
        job.slices.emplace(
            irradianceFromNodes(context, now.areaIrradiance, state_.level, state_.nodes, job.map));
    else
        job.slices.emplace(irradianceOfCharts(context, {now.indirectIrradiance, now.areaIrradiance},
                                              state_.level, state_.nodes, job.charts, job.map));
}

uint64_t MapUpdater::advance(std::optional<MapJob>& slot) {
    const uint64_t raysBefore = slot->rays, texels = state_.scene.atlas().texelCount();
    if (!slot->slices->next()) {
        publish(*slot);
        slot.reset();
        return texels / kTexelsStitchedPerRay;
    }
    // A slice passes over the other charts' texels in next to no time.
    const uint64_t rays = slot->rays - raysBefore,
                   rest = slot->slices->work() - std::min(rays, slot->slices->work());
    return rays + rest * texelsOf(slot->charts) / texels;
}

MapUpdater::Slice MapUpdater::advance() {
    assert(isRunning());
    // The area lights' map first: it lights the other.
    std::optional<MapJob>& job = areaJob_ ? areaJob_ : indirectJob_;
    Slice slice{.kind = job->kind};
    slice.work = advance(job);
    slice.finished = !job;
    return slice;
}

uint64_t MapUpdater::texelsOf(const ChartSet& charts) const {
    const Atlas& atlas = state_.scene.atlas();
    if (charts.empty()) return atlas.texelCount();
    uint64_t texels = 0;
    for (uint32_t c = 0; c < charts.size(); ++c)
        if (hasChart(charts, c))
            texels += uint64_t(atlas.charts[c].sizeTexels().x) * atlas.charts[c].sizeTexels().y;
    return texels;
}

void MapUpdater::publish(MapJob& job) {
    const GatherInput input = state_.input();
    const bool area = job.kind == MapKind::area, whole = job.charts.empty();
    std::vector<uint32_t>& shown =
        area ? state_.phatexture.areaIrradiance : state_.phatexture.indirectIrradiance;
    IrradianceMap& map = area ? areaMap_ : indirectMap_;
    mix(map, job.map, input.atlas, [&](uint32_t chart) {
        return whole ? job.newer.empty() || !hasChart(job.newer, chart) : hasChart(job.charts, chart);
    });
    // The charts of an object have seams with each other alone.
    std::vector<SeamPoint> seams;
    for (const SeamPoint& point : seams_)
        if (hasChart(job.charts, point.chart[0])) seams.push_back(point);
    IrradianceMap mean = state_.pass > 0 ? meanMap(area ? areaMean_ : indirectMean_, map, state_.pass) : map;
    std::vector<uint32_t> updated =
        area ? finishAreaIrradiance(std::move(mean), input, seams, job.progress)
             : finishIndirectIrradiance(std::move(mean), input, seams, job.progress);
    if (!whole)
        mix(updated, shown, input.atlas, [&](uint32_t chart) { return !hasChart(job.charts, chart); });
    const bool changed = replace(shown, std::move(updated));
    state_.areaVersion += changed && area;
    state_.irradianceVersion += changed;
    ++state_.revision;
    std::optional<MapJob>& ofAll = area ? areaJob_ : indirectJob_;
    if (!whole && ofAll) {
        ofAll->newer.resize(job.charts.size(), 0);
        for (size_t c = 0; c < job.charts.size(); ++c) ofAll->newer[c] |= job.charts[c];
    }
    // Those were mapped without the rest of it.
    if (whole && !job.newer.empty()) (area ? areaDirty_ : indirectDirty_) = true;
}

bool MapUpdater::replace(std::vector<uint32_t>& shown, std::vector<uint32_t> updated) {
    if (shown == updated) return false;
    for (size_t tile = 0; tile < state_.tileDirty.size(); ++tile) {
        if (state_.scene.atlas().tileChart[tile] == kNoChart) continue;
        for (uint32_t i = 0; i < kTileTexels; ++i) {
            const size_t texel = state_.texelOf(tile, i);
            if (shown[texel] == updated[texel]) continue;
            state_.tileDirty[tile] |= kDirtyIrradiance;
            break;
        }
    }
    shown = std::move(updated);
    return true;
}

void MapUpdater::beginPass() {
    assert(!areaIsStale() && !indirectIsStale());
    if (state_.pass == 0) {
        areaMean_ = areaMap_;
        indirectMean_ = indirectMap_;
    } else {
        areaMean_ = meanMap(areaMean_, areaMap_, state_.pass);
        indirectMean_ = meanMap(indirectMean_, indirectMap_, state_.pass);
    }
}

}  // namespace phat
