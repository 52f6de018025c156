#include "core/dynamic/light_update.h"

#include <algorithm>

#include "core/dynamic/baker_state.h"

namespace phat {

size_t texelOfTile(const Atlas& atlas, size_t tile, uint32_t inTile) {
    const uint32_t wide = atlas.sizeTiles().x;
    const glm::uvec2 texel =
        glm::uvec2(tile % wide, tile / wide) * kTileSize + glm::uvec2(inTile % kTileSize, inTile / kTileSize);
    return size_t(texel.y) * atlas.sizeTexels.x + texel.x;
}

LightUpdate collectUpdate(BakerState& state) {
    LightUpdate update;
    const Phatexture& now = state.phatexture;
    const Atlas& atlas = state.scene.atlas();
    for (uint32_t block = 0; block < state.blockDirty.size(); ++block)
        if (state.blockDirty[block]) {
            update.guides.push_back({block,
                                     state.guideOf(now.indirectGuides, block),
                                     state.hasArea ? now.areaGuides[block] : Guide{},
                                     {}});
            const auto take = [&](const PhatexelLayer& layer) {
                if (!layer.scrambles.empty())
                    update.guides.back().scrambles.push_back(layer.scrambles[block]);
            };
            for (const PhatexelLayer& layer : now.indirect) take(layer);
            if (state.hasArea) take(now.area[0]);
            state.blockDirty[block] = 0;
        }
    for (uint32_t tile = 0; tile < state.tileDirty.size(); ++tile) {
        const uint8_t dirty = state.tileDirty[tile];
        if (dirty & kDirtyPhatexels) {
            LightUpdate::Phatexels& taken = update.phatexels.emplace_back(
                LightUpdate::Phatexels{tile, atlas.blockAt(state.cornerOfTile(tile)), {}});
            const auto take = [&](const PhatexelLayer& layer) {
                for (uint32_t i = 0; i < kTileTexels; ++i)
                    taken.texels.push_back(layer.texels[state.texelOf(tile, i)]);
            };
            for (const PhatexelLayer& layer : now.indirect) take(layer);
            if (state.hasArea) take(now.area[0]);
        }
        if (dirty & kDirtyIrradiance) {
            LightUpdate::Irradiance& taken = update.irradiance.emplace_back();
            taken.tile = tile;
            for (uint32_t i = 0; i < kTileTexels; ++i) {
                const size_t texel = state.texelOf(tile, i);
                taken.indirect[i] = now.indirectIrradiance[texel];
                taken.area[i] = now.areaIrradiance.empty() ? 0 : now.areaIrradiance[texel];
            }
        }
        if (dirty & kDirtyGeometry)
            update.tileGeometries.push_back({tile, now.tilePatches[tile], now.probes[tile]});
        if (dirty & kDirtyCover) {
            LightUpdate::Occlusion& cover = update.occlusions.emplace_back();
            cover.tile = tile;
            for (uint32_t i = 0; i < kTileTexels; ++i)
                cover.state[i] = state.scene.points().state[state.texelOf(tile, i)];
        }
        state.tileDirty[tile] = 0;
    }
    std::stable_sort(update.phatexels.begin(), update.phatexels.end(),
                     [](const auto& a, const auto& b) { return a.block < b.block; });
    return update;
}

void applyUpdate(const LightUpdate& update, const Atlas& atlas, Phatexture& phatexture,
                 std::vector<TexelState>& states) {
    for (const LightUpdate::Guides& guides : update.guides) {
        if (phatexture.indirectGuides.size() > 1) phatexture.indirectGuides[guides.block] = guides.indirect;
        if (!phatexture.areaGuides.empty()) phatexture.areaGuides[guides.block] = guides.area;
        auto next = guides.scrambles.begin();
        for (auto* layers : {&phatexture.indirect, &phatexture.area})
            for (PhatexelLayer& layer : *layers)
                if (!layer.scrambles.empty() && next != guides.scrambles.end())
                    layer.scrambles[guides.block] = *next++;
    }
    for (const LightUpdate::Phatexels& tile : update.phatexels) {
        auto next = tile.texels.begin();
        for (auto* layers : {&phatexture.indirect, &phatexture.area})
            for (PhatexelLayer& layer : *layers)
                for (uint32_t i = 0; i < kTileTexels && next != tile.texels.end(); ++i)
                    layer.texels[texelOfTile(atlas, tile.tile, i)] = *next++;
    }
    for (const LightUpdate::Irradiance& tile : update.irradiance)
        for (uint32_t i = 0; i < kTileTexels; ++i) {
            const size_t texel = texelOfTile(atlas, tile.tile, i);
            phatexture.indirectIrradiance[texel] = tile.indirect[i];
            if (!phatexture.areaIrradiance.empty()) phatexture.areaIrradiance[texel] = tile.area[i];
        }
    for (const LightUpdate::TileGeometry& geometry : update.tileGeometries) {
        phatexture.probes[geometry.tile] = geometry.probe;
        phatexture.tilePatches[geometry.tile] = geometry.packed;
    }
    for (const LightUpdate::Occlusion& cover : update.occlusions)
        for (uint32_t i = 0; i < kTileTexels; ++i) states[texelOfTile(atlas, cover.tile, i)] = cover.state[i];
}

}  // namespace phat
