#include "core/dynamic/phatexel_updater.h"

#include "core/bake/irradiance_ray.h"
#include "core/phatexel/lookup_tables.h"

namespace phat {
namespace {

// Of these lamps the shadows that a change throws or lifts are looked for; more would cost more than the
// rays.
constexpr size_t kMostShadows = 4;
// Stored distances are right to 5.6 % (packDistance).
constexpr float kDistanceMargin = 1.06f;
// An object covers what is in its box, or so much of its size outside.
constexpr float kCoverReach = 0.1f;
// What else than rays costs time, in rays: building a block's guides (1.7 ms), a direction.
constexpr uint64_t kGuideWork = 5000;
constexpr uint64_t kDirectionWork = 2;

// Whether the segment meets the box. source: Williams et al. 2005, "An Efficient and Robust Ray-Box
// Intersection Algorithm".
bool meets(const Bounds& box, glm::vec3 origin, glm::vec3 direction, float distance) {
    const glm::vec3 inverse = 1.0f / direction;
    const glm::vec3 a = (box.low - origin) * inverse, b = (box.high - origin) * inverse;
    const glm::vec3 near = glm::min(a, b), far = glm::max(a, b);
    const float from = std::max({near.x, near.y, near.z, 0.0f});
    const float to = std::min({far.x, far.y, far.z, distance});
    return from <= to;  // false for the 0 * infinity of a ray in a face's plane; boxes are widened for it
}

Bounds widened(const Bounds& box, float by) {
    return {box.low - by, box.high + by};
}

/// What a tile has not heard of.
struct News {
    std::vector<Bounds> boxes;
    bool moved = false;  // the tile itself
};

News newsOf(const BakerState& state, size_t tile) {
    News news;
    news.moved = state.scene.movedAt(state.scene.atlas().tileChart[tile]) > state.tileScene[tile];
    for (const SceneChange& change : state.scene.changes())
        if (change.version > state.tileScene[tile])
            news.boxes.push_back(widened(change.box, 1e-3f * change.box.diagonal()));
    return news;
}

bool concerns(const News& news, const Scene& scene, glm::vec3 origin, glm::vec3 direction, float stored) {
    const float distance = stored * kDistanceMargin;
    const size_t lamps = std::min(scene.lights.size(), kMostShadows);
    for (const Bounds& box : news.boxes) {
        if (meets(box, origin, direction, distance)) return true;
        if (stored >= kFarDistance) continue;
        const glm::vec3 end = origin + stored * direction;
        for (size_t i = 0; i < lamps; ++i) {
            const PunctualLight& light = scene.lights[i];
            const bool parallel = light.type == PunctualLight::Type::directional;
            const glm::vec3 way = parallel ? -light.direction : light.position - end;
            const float length = glm::length(way);
            if (length > 0 && meets(box, end, way / length, parallel ? kFarDistance : length)) return true;
        }
    }
    return false;
}

struct Updater {
    const BakerState& state;
    const GatherInput input = state.input();
    const TexelIrradiance irradiance{state.phatexture.indirectIrradiance, state.phatexture.areaIrradiance};

    uint64_t seed = 0;  // of directions

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

void placeTile(BakerState& state, size_t tile, const DistanceProbe& probe) {
    state.phatexture.probes[tile] = probe;
    packPlace(state, tile);
}

}  // namespace

void packPlace(BakerState& state, size_t tile) {
    const Atlas& atlas = state.scene.atlas();
    if (atlas.tileChart[tile] == kNoChart) return;
    const Frame& frame = state.scene.frames()[atlas.blockAt(state.cornerOfTile(tile))];
    state.phatexture.tilePlaces[tile] = packedTileOf(state.phatexture, atlas, state.scene.patches()[tile],
                                                     frame, state.phatexture.probes[tile], tile);
    state.tileDirty[tile] |= kDirtyPlace;
}

bool mayCover(const BakerState& state, size_t tile) {
    const TilePatch& patch = state.scene.patches()[tile];
    const float reach = 0.5f * float(kTileSize) * (glm::length(patch.alongX) + glm::length(patch.alongY));
    const News news = newsOf(state, tile);
    if (news.moved) return true;
    for (const Bounds& box : news.boxes) {
        const Bounds around = widened(box, reach + kCoverReach * box.diagonal());
        if (glm::all(glm::greaterThanEqual(patch.center, around.low)) &&
            glm::all(glm::lessThanEqual(patch.center, around.high)))
            return true;
    }
    return false;
}

TileUpdate updateTile(const BakerState& state, size_t tile, bool coverChanged) {
    TileUpdate update;
    const News news = newsOf(state, tile);
    const TexelPoints& points = state.scene.points();
    const uint32_t block = state.scene.atlas().blockAt(state.cornerOfTile(tile));
    const Updater updater{.state = state, .seed = state.blockAge[block].seed};
    const Frame& frame = state.scene.frames()[block];
    const Phatexture& now = state.phatexture;
    update.work = kTileTexels;

    const auto stale = [&](PackedPhatexel packed, size_t texel) {
        const bool valid = packed.directionDistance != 0;
        if (coverChanged || news.moved) return points.valid(texel) || valid;
        if (!valid || !points.valid(texel)) return false;
        const Phatexel phatexel = unpackPhatexel(packed);
        return concerns(news, state.scene.scene(), points.position[texel],
                        frame.toWorld(phatexel.directionBlock), phatexel.distance);
    };
    std::vector<PackedPhatexel> texels;
    const auto layerOf = [&](const PhatexelLayer& layer, const auto& renew) {
        for (uint32_t i = 0; i < kTileTexels; ++i) {
            const size_t texel = state.texelOf(tile, i);
            texels.push_back(layer.texels[texel]);
            if (!stale(texels.back(), texel)) continue;
            texels.back() = renew(texel);
            ++update.phatexels;
        }
    };
    for (size_t l = 0; l < now.indirect.size(); ++l)
        layerOf(now.indirect[l], [&](size_t texel) {
            return updater.indirect(state.guideOf(now.indirectGuides, block), texel, int(l), update.work);
        });
    if (state.hasArea)
        layerOf(now.area[0], [&](size_t texel) {
            return updater.area(state.guideOf(now.areaGuides, block), texel, update.work);
        });
    if (update.phatexels == 0) return update;
    update.texels = std::move(texels);
    update.probe = traceDistanceProbe(state.scene.atlas(), points, state.scene.frames(),
                                      state.scene.patches()[tile], tile, *state.rays);
    update.work += kProbeSize * kProbeSize;
    return update;
}

void commit(BakerState& state, size_t tile, const TileUpdate& update) {
    state.tileScene[tile] = state.scene.version();
    if (update.texels.empty()) return;
    size_t next = 0;
    const auto take = [&](PhatexelLayer& layer) {
        for (uint32_t i = 0; i < kTileTexels; ++i)
            layer.texels[state.texelOf(tile, i)] = update.texels[next++];
    };
    for (PhatexelLayer& layer : state.phatexture.indirect) take(layer);
    if (state.hasArea) take(state.phatexture.area[0]);
    placeTile(state, tile, update.probe);
    state.tileDirty[tile] |= kDirtyPhatexels;
}

BlockUpdate updateBlock(const BakerState& state, uint32_t block) {
    BlockUpdate update;
    const Atlas& atlas = state.scene.atlas();
    const TexelPoints& points = state.scene.points();
    const BlockPlace& place = state.blocks[block];
    const Updater updater{.state = state, .seed = state.settings.seed};
    update.indirectGuide = state.guideOf(state.phatexture.indirectGuides, block);
    if (state.guided() || state.hasArea) {
        std::vector<PhotonSet> sets;
        for (const std::optional<PhotonMapPart>& part : state.photons)
            if (part) sets.push_back({part->map, part->index});
        std::vector<PhotonIndex::Neighbor> near;
        const Bounds bounds = blockBounds(atlas, points, place);
        const Frame& frame = state.scene.frames()[block];
        if (state.guided()) update.indirectGuide = buildGuide(bounds, frame, sets, isIndirectPhoton, near);
        if (state.hasArea) update.areaGuide = buildGuide(bounds, frame, sets, isAreaPhoton, near);
        update.work += kGuideWork;
    }
    update.indirect.resize(state.phatexture.indirect.size());
    for (uint32_t y = 0; y < place.size.y; ++y)
        for (uint32_t x = 0; x < place.size.x; ++x) {
            const size_t texel = size_t(place.origin.y + y) * atlas.sizeTexels.x + place.origin.x + x;
            for (size_t l = 0; l < update.indirect.size(); ++l)
                update.indirect[l].push_back(
                    updater.indirect(update.indirectGuide, texel, int(l), update.work));
            if (state.hasArea) update.area.push_back(updater.area(update.areaGuide, texel, update.work));
            if (points.valid(texel)) update.phatexels += uint32_t(update.indirect.size()) + state.hasArea;
        }
    for (uint32_t y = place.origin.y / kTileSize; y < (place.origin.y + place.size.y) / kTileSize; ++y)
        for (uint32_t x = place.origin.x / kTileSize; x < (place.origin.x + place.size.x) / kTileSize; ++x) {
            const size_t tile = size_t(y) * atlas.sizeTiles().x + x;
            update.probes.push_back(traceDistanceProbe(atlas, points, state.scene.frames(),
                                                       state.scene.patches()[tile], tile, *state.rays));
            update.work += kProbeSize * kProbeSize;
        }
    return update;
}

void commit(BakerState& state, uint32_t block, const BlockUpdate& update) {
    const Atlas& atlas = state.scene.atlas();
    const BlockPlace& place = state.blocks[block];
    if (state.guided()) state.phatexture.indirectGuides[block] = update.indirectGuide;
    if (state.hasArea) state.phatexture.areaGuides[block] = update.areaGuide;
    const auto take = [&](PhatexelLayer& layer, const std::vector<PackedPhatexel>& texels) {
        for (uint32_t y = 0; y < place.size.y; ++y)
            std::copy_n(texels.begin() + ptrdiff_t(y * place.size.x), place.size.x,
                        layer.texels.begin() +
                            ptrdiff_t(size_t(place.origin.y + y) * atlas.sizeTexels.x + place.origin.x));
    };
    for (size_t l = 0; l < update.indirect.size(); ++l)
        take(state.phatexture.indirect[l], update.indirect[l]);
    if (state.hasArea) take(state.phatexture.area[0], update.area);
    BlockAge& age = state.blockAge[block];
    if (age.seed != state.settings.seed) {
        age.seed = state.settings.seed;
        const auto scramble = [&](PhatexelLayer& layer, int index) {
            if (!layer.scrambles.empty())
                layer.scrambles[block] =
                    scrambleOf({state.settings.directions, state.settings.density, age.seed, index}, block);
        };
        for (size_t l = 0; l < update.indirect.size(); ++l) scramble(state.phatexture.indirect[l], int(l));
        if (state.hasArea) scramble(state.phatexture.area[0], -1);
    }
    size_t next = 0;
    for (uint32_t y = place.origin.y / kTileSize; y < (place.origin.y + place.size.y) / kTileSize; ++y)
        for (uint32_t x = place.origin.x / kTileSize; x < (place.origin.x + place.size.x) / kTileSize; ++x) {
            const size_t tile = size_t(y) * atlas.sizeTiles().x + x;
            placeTile(state, tile, update.probes[next++]);
            state.tileDirty[tile] |= kDirtyPhatexels;
        }
    state.blockDirty[block] = 1;
    age.scene = state.scene.version();
    age.photons = state.photonsVersion();
    age.irradiance = state.irradianceVersion;
}

size_t adaptNodes(BakerState& state) {
    if (state.levelTexelsVersion == state.scene.texelsVersion()) return state.nodes.size();
    const uint32_t width = state.scene.atlas().sizeTexels.x;
    IrradianceLevel level = coarseLevel(state.input());
    std::vector<NodeRays> nodes(level.texel.size());
    std::vector<NodeAge> ages(nodes.size());
    for (size_t n = 0; n < nodes.size() && !state.level.node.empty(); ++n) {
        const uint32_t before = state.level.node[level.groupOf(level.texel[n], width)];
        if (before == kNoNode || state.level.texel[before] != level.texel[n]) continue;
        nodes[n] = state.nodes[before];
        ages[n] = state.nodeAge[before];
        // Rays that ended in what is covered now tell nothing until they are traced again.
        for (uint32_t i = 0; i < nodes[n].count; ++i) {
            uint32_t& texel = nodes[n].texel[i];
            if (texel != kNoTexel && level.node[level.groupOf(texel, width)] == kNoNode) texel = kNoTexel;
        }
    }
    state.level = std::move(level);
    state.nodes = std::move(nodes);
    state.nodeAge = std::move(ages);
    state.levelTexelsVersion = state.scene.texelsVersion();
    return state.nodes.size();
}

bool allNodesKnown(const BakerState& state) {
    return std::all_of(state.nodeAge.begin(), state.nodeAge.end(),
                       [](const NodeAge& age) { return age.scene != 0; });
}

bool publish(BakerState& state, std::vector<uint32_t>& map, std::vector<uint32_t> renewed) {
    if (map == renewed) return false;
    for (size_t tile = 0; tile < state.tileDirty.size(); ++tile) {
        if (state.scene.atlas().tileChart[tile] == kNoChart) continue;
        for (uint32_t i = 0; i < kTileTexels; ++i) {
            const size_t texel = state.texelOf(tile, i);
            if (map[texel] == renewed[texel]) continue;
            state.tileDirty[tile] |= kDirtyIrradiance;
            break;
        }
    }
    map = std::move(renewed);
    return true;
}

}  // namespace phat
