#include "core/dynamic/phatexel_updater.h"

#include "core/bake/irradiance_ray.h"
#include "core/base/parallel.h"
#include "core/dynamic/pending_changes.h"
#include "core/phatexel/lookup_tables.h"

namespace phat {

/// A tile's PHATexels after a change.
struct TileUpdate {
    std::vector<PackedPhatexel> texels;  // as LightUpdate::Phatexels; empty: nothing has changed
    DepthProbe probe;
    uint64_t work = 0;  // rays, or as long as so many take
    uint32_t phatexels = 0;
};

/// All of a block.
struct BlockUpdate {
    Guide indirectGuide, areaGuide;
    std::vector<std::vector<PackedPhatexel>> indirect;  // [layer][y][x] of the block
    std::vector<PackedPhatexel> area;
    std::vector<DepthProbe> probes;  // of its tiles [y][x]
    uint64_t work = 0;
    uint32_t phatexels = 0;
};

namespace {

// What else than rays costs time, in rays: building a block's guides (1.7 ms), a direction, tracing a photon
// and sorting it in, testing whether a texel is occluded.
constexpr uint64_t kGuideWork = 5000, kDirectionWork = 2, kPhotonWork = 4, kCoverWork = 16;

// Calls body(i) for all items in parallel.
template <typename Body>
void forAll(size_t count, const Body& body) {
    SilentProgress silent;
    parallelRanges(count, 1, silent, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) body(i);
    });
}

struct TexelUpdater {
    const BakerState& state;
    const uint64_t seed;  // of directions
    const GatherInput input = state.input();
    const TexelIrradiance irradiance{state.phatexture.indirectIrradiance, state.phatexture.areaIrradiance};

    PackedPhatexel indirect(const Guide& guide, size_t texel, int layer, uint64_t& work) const {
        const TexelDirection direction = directionOf(guide, texel, layer);
        work += kDirectionWork;
        return indirectPhatexel({input, irradiance, state.settings, layer}, direction, texel, work);
    }
    PackedPhatexel area(const Guide& guide, size_t texel, uint64_t& work) const {
        work += kDirectionWork;
        return areaPhatexel(input, directionOf(guide, texel, -1), texel, work);
    }

  private:
    TexelDirection directionOf(const Guide& guide, size_t texel, int layer) const {
        if (!input.points.valid(texel)) return {};
        const uint32_t width = input.atlas.sizeTexels.x;
        return chooseDirection(input.atlas, guide, {texel % width, texel / width},
                               {state.settings.directions, state.settings.density, seed, layer});
    }
};

DepthProbe traceProbe(const BakerState& state, size_t tile) {
    return traceDepthProbe(state.scene.atlas(), state.scene.points(), state.scene.frames(),
                           state.scene.patches()[tile], tile, *state.rays);
}

// Calls body(tile) for the tiles of a block [y][x].
template <typename Body>
void forTilesOf(const BakerState& state, uint32_t block, const Body& body) {
    const glm::uvec2 first = state.blocks[block].origin / kTileSize;
    const glm::uvec2 end = (state.blocks[block].origin + state.blocks[block].size) / kTileSize;
    for (uint32_t y = first.y; y < end.y; ++y)
        for (uint32_t x = first.x; x < end.x; ++x) body(size_t(y) * state.scene.atlas().sizeTiles().x + x);
}

void setProbe(BakerState& state, size_t tile, const DepthProbe& probe) {
    state.phatexture.probes[tile] = probe;
    packTile(state, tile);
    state.tileDirty[tile] |= kDirtyPhatexels;
}

}  // namespace

void packTile(BakerState& state, size_t tile) {
    const Atlas& atlas = state.scene.atlas();
    if (atlas.tileChart[tile] == kNoChart) return;
    const Frame& frame = state.scene.frames()[atlas.blockAt(state.cornerOfTile(tile))];
    state.phatexture.tilePatches[tile] = packedTileOf(state.phatexture, atlas, state.scene.patches()[tile],
                                                      frame, state.phatexture.probes[tile], tile);
    state.tileDirty[tile] |= kDirtyGeometry;
}

PhatexelUpdater::PhatexelUpdater(BakerState& state) : state_(state), photons_(state.photonsScene.size()) {}

TileUpdate PhatexelUpdater::updateTile(size_t tile, bool coverChanged) const {
    TileUpdate update;
    const PendingChanges changes(state_, tile);
    const TexelPoints& points = state_.scene.points();
    const uint32_t block = state_.scene.atlas().blockAt(state_.cornerOfTile(tile));
    const TexelUpdater updater{.state = state_, .seed = state_.blockAge[block].seed};
    const Frame& frame = state_.scene.frames()[block];
    const Phatexture& now = state_.phatexture;
    update.work = kTileTexels;

    const auto stale = [&](PackedPhatexel packed, size_t texel) {
        const bool valid = packed.directionDistance != 0;
        if (coverChanged || changes.moved()) return points.valid(texel) || valid;
        if (!valid || !points.valid(texel)) return false;
        const Phatexel phatexel = unpackPhatexel(packed, state_.scene.atlas().unitMeters);
        return changes.affectRay(state_.scene.scene(), points.position[texel],
                                 frame.toWorld(phatexel.directionBlock), phatexel.distance);
    };
    std::vector<PackedPhatexel> texels;
    const auto layerOf = [&](const PhatexelLayer& layer, const auto& retrace) {
        for (uint32_t i = 0; i < kTileTexels; ++i) {
            const size_t texel = state_.texelOf(tile, i);
            texels.push_back(layer.texels[texel]);
            if (!stale(texels.back(), texel)) continue;
            texels.back() = retrace(texel);
            ++update.phatexels;
        }
    };
    for (size_t l = 0; l < now.indirect.size(); ++l)
        layerOf(now.indirect[l], [&](size_t texel) {
            return updater.indirect(state_.guideOf(now.indirectGuides, block), texel, int(l), update.work);
        });
    if (state_.hasArea)
        layerOf(now.area[0], [&](size_t texel) {
            return updater.area(state_.guideOf(now.areaGuides, block), texel, update.work);
        });
    if (update.phatexels == 0) return update;
    update.texels = std::move(texels);
    update.probe = traceProbe(state_, tile);
    update.work += kProbeSize * kProbeSize;
    return update;
}

void PhatexelUpdater::commit(size_t tile, const TileUpdate& update) {
    state_.tileScene[tile] = state_.scene.version();
    state_.tileClock[tile] = state_.clock;
    updated_ += update.phatexels;
    if (update.texels.empty()) return;
    size_t next = 0;
    const auto take = [&](PhatexelLayer& layer) {
        for (uint32_t i = 0; i < kTileTexels; ++i)
            layer.texels[state_.texelOf(tile, i)] = update.texels[next++];
    };
    for (PhatexelLayer& layer : state_.phatexture.indirect) take(layer);
    if (state_.hasArea) take(state_.phatexture.area[0]);
    setProbe(state_, tile, update.probe);
}

uint64_t PhatexelUpdater::retraceInvalidated(std::span<const uint32_t> tiles) {
    std::vector<uint8_t> coverTested(tiles.size(), 0), coverChanged(tiles.size(), 0);
    forAll(tiles.size(), [&](size_t i) {
        coverTested[i] = PendingChanges(state_, tiles[i]).mayCover(state_.scene.patches()[tiles[i]]);
        if (coverTested[i]) state_.scene.markOccluded(tiles[i], *state_.rays);
    });
    uint64_t work = 0;
    bool anyChanged = false;
    for (size_t i = 0; i < tiles.size(); ++i) {
        if (!coverTested[i]) continue;
        work += kCoverWork * kTileTexels;
        coverChanged[i] = state_.scene.commitOccluded(tiles[i]);
        if (coverChanged[i]) state_.tileDirty[tiles[i]] |= kDirtyCover;
        anyChanged |= coverChanged[i] != 0;
    }
    std::vector<TileUpdate> updates(tiles.size());
    forAll(tiles.size(), [&](size_t i) { updates[i] = updateTile(tiles[i], coverChanged[i] != 0); });
    for (size_t i = 0; i < tiles.size(); ++i) {
        commit(size_t(tiles[i]), updates[i]);
        work += updates[i].work;
    }
    // Rays end in texels, so occlusion of texels affects all of them.
    state_.scene.endOccluded(anyChanged);
    state_.revision += anyChanged;
    return work;
}

uint64_t PhatexelUpdater::tracePhotonPart(uint32_t part, Progress& progress) {
    const uint64_t count = state_.settings.photons.count, parts = photons_.size();
    const uint64_t begin = count * part / parts, end = count * (part + 1) / parts;
    photons_[part].emplace(
        phat::tracePhotonPart(*state_.rays, *state_.lights, state_.settings.photons, begin, end, progress));
    state_.photonsScene[part] = state_.scene.version();
    return kPhotonWork * (end - begin);
}

BlockUpdate PhatexelUpdater::updateBlock(uint32_t block) const {
    BlockUpdate update;
    const Atlas& atlas = state_.scene.atlas();
    const TexelPoints& points = state_.scene.points();
    const BlockRect& rect = state_.blocks[block];
    const TexelUpdater updater{.state = state_, .seed = state_.settings.seed};
    update.indirectGuide = state_.guideOf(state_.phatexture.indirectGuides, block);
    if (state_.guided() || state_.hasArea) {
        std::vector<PhotonSet> sets;
        for (const std::optional<PhotonMapPart>& part : photons_)
            if (part) sets.push_back({part->map, part->index});
        std::vector<PhotonIndex::Neighbor> near;
        const Bounds bounds = blockBounds(atlas, points, rect);
        const Frame& frame = state_.scene.frames()[block];
        if (state_.guided())
            update.indirectGuide = buildGuide(bounds, frame, atlas.unitMeters, sets, isIndirectPhoton, near);
        if (state_.hasArea)
            update.areaGuide = buildGuide(bounds, frame, atlas.unitMeters, sets, isAreaPhoton, near);
        update.work += kGuideWork;
    }
    update.indirect.resize(state_.phatexture.indirect.size());
    for (uint32_t y = 0; y < rect.size.y; ++y)
        for (uint32_t x = 0; x < rect.size.x; ++x) {
            const size_t texel = size_t(rect.origin.y + y) * atlas.sizeTexels.x + rect.origin.x + x;
            for (size_t l = 0; l < update.indirect.size(); ++l)
                update.indirect[l].push_back(
                    updater.indirect(update.indirectGuide, texel, int(l), update.work));
            if (state_.hasArea) update.area.push_back(updater.area(update.areaGuide, texel, update.work));
            if (points.valid(texel)) update.phatexels += uint32_t(update.indirect.size()) + state_.hasArea;
        }
    forTilesOf(state_, block, [&](size_t tile) {
        update.probes.push_back(traceProbe(state_, tile));
        update.work += kProbeSize * kProbeSize;
    });
    return update;
}

void PhatexelUpdater::updateScrambles(uint32_t block) {
    BlockAge& age = state_.blockAge[block];
    if (age.seed == state_.settings.seed) return;
    age.seed = state_.settings.seed;
    const auto scramble = [&](PhatexelLayer& layer, int index) {
        if (!layer.scrambles.empty())
            layer.scrambles[block] =
                scrambleOf({state_.settings.directions, state_.settings.density, age.seed, index}, block);
    };
    std::vector<PhatexelLayer>& indirect = state_.phatexture.indirect;
    for (size_t l = 0; l < indirect.size(); ++l) scramble(indirect[l], int(l));
    if (state_.hasArea) scramble(state_.phatexture.area[0], -1);
}

void PhatexelUpdater::commit(uint32_t block, const BlockUpdate& update) {
    const uint32_t width = state_.scene.atlas().sizeTexels.x;
    const BlockRect& rect = state_.blocks[block];
    if (state_.guided()) state_.phatexture.indirectGuides[block] = update.indirectGuide;
    if (state_.hasArea) state_.phatexture.areaGuides[block] = update.areaGuide;
    const auto take = [&](PhatexelLayer& layer, const std::vector<PackedPhatexel>& texels) {
        for (uint32_t y = 0; y < rect.size.y; ++y)
            std::copy_n(texels.begin() + ptrdiff_t(y * rect.size.x), rect.size.x,
                        layer.texels.begin() + ptrdiff_t(size_t(rect.origin.y + y) * width + rect.origin.x));
    };
    for (size_t l = 0; l < update.indirect.size(); ++l)
        take(state_.phatexture.indirect[l], update.indirect[l]);
    if (state_.hasArea) take(state_.phatexture.area[0], update.area);
    updateScrambles(block);
    auto probe = update.probes.begin();
    forTilesOf(state_, block, [&](size_t tile) { setProbe(state_, tile, *probe++); });
    state_.blockDirty[block] = 1;
    BlockAge& age = state_.blockAge[block];
    age.scene = state_.scene.version();
    age.photons = state_.photonsVersion();
    age.irradiance = state_.irradianceVersion;
    age.clock = state_.clock;
    updated_ += update.phatexels;
}

uint64_t PhatexelUpdater::updateBlocks(std::span<const uint32_t> blocks) {
    std::vector<BlockUpdate> updates(blocks.size());
    forAll(blocks.size(), [&](size_t i) { updates[i] = updateBlock(blocks[i]); });
    uint64_t work = 0;
    for (size_t i = 0; i < blocks.size(); ++i) {
        commit(blocks[i], updates[i]);
        work += updates[i].work;
    }
    return work;
}

}  // namespace phat
