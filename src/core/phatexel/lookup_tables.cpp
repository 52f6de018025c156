#include "core/phatexel/lookup_tables.h"

#include <algorithm>
#include <cmath>

namespace phat {

InverseCdf inverseCdfOf(const Guide& guide) {
    const auto code = [](double x) { return uint8_t(std::lround(255.0 * x)); };
    std::array<double, kGuideSize> rows{};
    double total = 0;
    for (int i = 0; i < kGuideCells; ++i) {
        rows[i / kGuideSize] += guide.weight[i];
        total += guide.weight[i];
    }
    InverseCdf cells;
    double above = 0;
    for (int y = 0; y < kGuideSize; ++y) {
        double before = 0;
        for (int x = 0; x < kGuideSize; ++x) {
            const double weight = guide.weight[y * kGuideSize + x];
            cells[y * kGuideSize + x] = {code(before / rows[y]), code((before + weight) / rows[y]),
                                         code(above / total), code((above + rows[y]) / total)};
            before += weight;
        }
        above += rows[y];
    }
    return cells;
}

bool canLookUp(const std::vector<PhatexelLayer>& layers, const std::vector<Guide>& guides) {
    return !layers.empty() && !guides.empty() &&
           std::none_of(layers.begin(), layers.end(),
                        [](const PhatexelLayer& layer) { return layer.scrambles.empty(); });
}

PackedTile packedTileOf(const Phatexture& phatexture, const Atlas& atlas, const TilePatch& patch,
                        const Frame& frame, const DepthProbe& probe, size_t tile) {
    const glm::uvec2 tilePosition(tile % atlas.sizeTiles().x, tile / atlas.sizeTiles().x);
    const bool indirect = canLookUp(phatexture.indirect, phatexture.indirectGuides);
    return packTile(patch, frame, atlas.charts[atlas.tileChart[tile]].texelSizeMeters,
                    indirect ? phatexture.indirect[0].scrambles[atlas.blockAt(tilePosition * kTileSize)] : 0,
                    {probe.low, probe.high});
}

void prepareLookup(Phatexture& phatexture, const Atlas& atlas, const TexelPoints& points,
                   const std::vector<Frame>& frames, const RayScene& rays, Progress& progress) {
    const std::vector<TilePatch> patches = fitTilePatches(atlas, points, frames);
    if (canLookUp(phatexture.indirect, phatexture.indirectGuides) ||
        canLookUp(phatexture.area, phatexture.areaGuides)) {
        ProgressStage stage(progress, "distances", patches.size());
        phatexture.probes = traceDepthProbes(atlas, points, frames, patches, rays, progress);
    }
    packTiles(phatexture, atlas, patches, frames);
}

void packTiles(Phatexture& phatexture, const Atlas& atlas, const std::vector<TilePatch>& patches,
               const std::vector<Frame>& frames) {
    const glm::uvec2 tiles = atlas.sizeTiles();
    phatexture.tilePatches.assign(patches.size(), {glm::uvec4(0), glm::uvec4(0)});
    for (uint32_t i = 0; i < patches.size(); ++i) {
        if (atlas.tileChart[i] == kNoChart) continue;
        const uint32_t block = atlas.blockAt(glm::uvec2(i % tiles.x, i / tiles.x) * kTileSize);
        const DepthProbe probe = phatexture.probes.empty() ? DepthProbe{} : phatexture.probes[i];
        phatexture.tilePatches[i] = packedTileOf(phatexture, atlas, patches[i], frames[block], probe, i);
    }
}

}  // namespace phat
