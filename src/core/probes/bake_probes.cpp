#include "core/probes/bake_probes.h"

#include "core/bake/gather_parts.h"
#include "core/probes/probe_grid.h"
#include "core/scene/enclosure.h"

namespace phat {
namespace {

// Corners of the grid, of all probes; and of what is then left, those of the first division.
constexpr float kGridFraction = 0.35f, kFirstDivisionFraction = 0.6f;
// Of the smallest cells that a corner was made for: how near surfaces may be.
constexpr float kClearance = 0.0625f;

// Gathers at the corners that have no probe yet.
void gatherMissing(const ProbeGrid& grid, const ProbeWorld& world, const ProbeRun& run,
                   std::vector<ProbeRays>& probes) {
    const size_t first = probes.size();
    std::vector<ProbeRays> added(grid.corners.size() - first);
    const float unit = std::max({grid.cellMeters.x, grid.cellMeters.y, grid.cellMeters.z});
    const uint64_t key = hashOf(uint64_t(GatherStage::lightProbes), first);
    constexpr size_t kPartProbes = 16;
    fillParts(
        added, key, run,
        [&](size_t i, uint64_t& rays) {
            const GridCorner& corner = grid.corners[first + i];
            added[i] = gatherProbe(world, grid.positionOf(corner),
                                   std::ldexp(kClearance * unit, -corner.division), first + i, rays);
        },
        kPartProbes);
    probes.insert(probes.end(), added.begin(), added.end());
}

}  // namespace

LightProbes bakeLightProbes(const ProbeInput& input, const ProbeSettings& settings, const ProbeRun& run) {
    const Scene& scene = input.rays.scene();
    if (settings.count <= 0 || scene.triangles.empty()) return {};
    const LightSampler lights(scene);
    const std::vector<uint8_t> receivers = irradianceTexels(input.atlas, input.points);
    const TexelWorld texels{{input.rays, lights}, input.atlas, input.points, receivers};
    const TexelIrradiance irradiance{input.phatexture.indirectIrradiance, input.phatexture.areaIrradiance};
    const ProbeWorld world{texels, irradiance, settings.seed};

    const size_t count = std::min(size_t(settings.count), kMaxProbes);
    ProgressStage stage(run.progress, "light probes", count);
    ProbeGrid grid = layOutGrid(boundsWithoutGround(scene), size_t(kGridFraction * float(count)));
    std::vector<ProbeRays> probes;
    gatherMissing(grid, world, run, probes);
    for (int division = 0; division < kMaxCellDivisions; ++division) {
        const size_t left = count - std::min(count, probes.size());
        const float fraction = division == 0 ? kFirstDivisionFraction : 1.0f;
        for (const size_t cell : cellsToDivide(grid, probes, division, size_t(fraction * float(left))))
            grid.divide(cell);
        gatherMissing(grid, world, run, probes);
    }
    return packProbes(grid, probes);
}

}  // namespace phat
