#include "core/dynamic/urgency.h"

#include <algorithm>
#include <optional>

#include "core/base/parallel.h"
#include "core/dynamic/view_test.h"

namespace phat {
namespace {

// The number of latest boxes that decide the order.
constexpr size_t kRecentChanges = 16;
// Factor for tiles outside the view: they still light visible surfaces.
constexpr float kOutOfView = 0.25f;
// Of tiles far from any change, so that the camera decides among them.
constexpr float kMinValue = 0.25f;
// Moved objects carry stale irradiance: they come first unless another item is older by two passes.
constexpr float kMovedBonus = 2.0f;
// A pass over everything, in rays a texel: by its age an item's urgency grows by 1 in that time.
constexpr uint64_t kPassWork = 64;

}  // namespace

std::vector<float> tileValues(const BakerState& state, const Camera* camera) {
    const Atlas& atlas = state.scene.atlas();
    // A change of the whole scene gives all tiles the same urgency.
    std::vector<SceneChange> changes;
    for (const SceneChange& change : state.scene.changes())
        if (change.kind != SceneChange::Kind::wholeScene) changes.push_back(change);
    const auto recent = std::span(std::as_const(changes)).last(std::min(changes.size(), kRecentChanges));
    std::optional<ViewTest> view;
    if (camera) view.emplace(*camera);
    std::vector<float> values(atlas.tileChart.size(), 0.0f);
    SilentProgress silent;
    parallelRanges(values.size(), 512, silent, [&](size_t begin, size_t end) {
        for (size_t tile = begin; tile < end; ++tile) {
            const TilePatch& patch = state.scene.patches()[tile];
            if (atlas.tileChart[tile] == kNoChart) continue;
            const glm::vec3 normal = state.scene.frames()[atlas.blockAt(state.cornerOfTile(tile))].normal;
            float value = 0;
            for (const SceneChange& change : recent) {
                const float radius = 0.5f * change.box.diagonal();
                const glm::vec3 toChange = change.box.center() - patch.center;
                if (glm::dot(toChange, normal) < -radius) continue;  // behind
                // The solid angle of the box's bounding sphere, over half the sky.
                value =
                    std::max(value, square(radius) / std::max(glm::dot(toChange, toChange), square(radius)));
            }
            const float radius =
                0.5f * float(kTileSize) * (glm::length(patch.alongX) + glm::length(patch.alongY));
            values[tile] = (value + kMinValue) *
                           (!view || view->maySee(patch.center, normal, radius) ? 1.0f : kOutOfView);
        }
    });
    return values;
}

namespace {

struct Item {
    float urgency;
    uint32_t index;
};

/// Lists the stale items of each task.
struct StaleItems {
    const BakerState& state;
    const std::vector<float>& tileValue;
    const Atlas& atlas = state.scene.atlas();
    const uint64_t version = state.scene.version(), work = passWork(atlas);
    std::vector<Item> items = {};

    void add(uint32_t index, float value, uint64_t updatedAt) {
        items.push_back({value + float(double(state.clock - updatedAt) / double(work)), index});
    }

    float valueIn(glm::uvec2 corner, glm::uvec2 size) const {
        float value = 0;
        for (uint32_t y = corner.y / kTileSize; y < (corner.y + size.y) / kTileSize; ++y)
            for (uint32_t x = corner.x / kTileSize; x < (corner.x + size.x) / kTileSize; ++x)
                value = std::max(value, tileValue[size_t(y) * atlas.sizeTiles().x + x]);
        return value;
    }

    void addTiles() {
        for (uint32_t t = 0; t < tileValue.size(); ++t) {
            if (atlas.tileChart[t] == kNoChart || state.tileScene[t] >= version) continue;
            const bool moved = state.scene.movedAt(atlas.tileChart[t]) > state.tileScene[t];
            add(t, tileValue[t] + (moved ? kMovedBonus : 0.0f), state.tileClock[t]);
        }
    }

    void addPhotonParts() {
        for (uint32_t p = 0; p < state.photonsScene.size(); ++p)
            if (state.photonsScene[p] < version) items.push_back({float(version - state.photonsScene[p]), p});
    }

    void addRegions() {
        const uint32_t wide = (atlas.sizeTexels.x + kBlockSize - 1) / kBlockSize;
        for (uint32_t r = 0; r < state.regionScene.size(); ++r) {
            if (state.regionScene[r] == version) continue;
            const glm::uvec2 corner = glm::uvec2(r % wide, r / wide) * kBlockSize;
            add(r, valueIn(corner, glm::min(glm::uvec2(kBlockSize), atlas.sizeTexels - corner)),
                state.regionClock[r]);
        }
    }

    void addNodes() {
        const bool areaKnown = std::all_of(state.regionScene.begin(), state.regionScene.end(),
                                           [&](uint64_t scene) { return scene == version; });
        const uint32_t width = atlas.sizeTexels.x;
        for (uint32_t n = 0; n < state.nodes.size(); ++n) {
            const NodeAge& age = state.nodeAge[n];
            if (age.scene == version && (!areaKnown || age.area == state.areaVersion)) continue;
            const uint32_t texel = state.level.texel[n];
            const glm::uvec2 tile = glm::uvec2(texel % width, texel / width) / kTileSize;
            add(n, tileValue[tile.y * atlas.sizeTiles().x + tile.x] + float(age.scene == 0), age.clock);
        }
    }

    void addBlocks(bool irradianceKnown) {
        const bool photonsKnown = state.photonsVersion() == version;
        for (uint32_t b = 0; b < state.blockAge.size(); ++b) {
            const BlockAge& age = state.blockAge[b];
            if (age.scene == version && (!photonsKnown || age.photons == version) &&
                (!irradianceKnown || age.irradiance == state.irradianceVersion))
                continue;
            add(b, valueIn(state.blocks[b].origin, state.blocks[b].size), age.clock);
        }
    }
};

}  // namespace

uint64_t passWork(const Atlas& atlas) {
    return kPassWork * atlas.texelCount();
}

std::vector<uint32_t> urgentFirst(const BakerState& state, BakerTask task,
                                  const std::vector<float>& tileValue, bool irradianceKnown) {
    StaleItems stale{.state = state, .tileValue = tileValue};
    switch (task) {
        case BakerTask::retraceInvalidated:
            stale.addTiles();
            break;
        case BakerTask::photons:
            stale.addPhotonParts();
            break;
        case BakerTask::areaLight:
            stale.addRegions();
            break;
        case BakerTask::nodes:
            stale.addNodes();
            break;
        case BakerTask::blocks:
            stale.addBlocks(irradianceKnown);
            break;
        case BakerTask::moved:  // these have no items
        case BakerTask::maps:
            break;
    }
    // Equal urgency: in the order of the atlas.
    std::sort(stale.items.begin(), stale.items.end(), [](const Item& a, const Item& b) {
        return a.urgency != b.urgency ? a.urgency > b.urgency : a.index < b.index;
    });
    std::vector<uint32_t> order;
    order.reserve(stale.items.size());
    for (const Item& item : stale.items) order.push_back(item.index);
    return order;
}

}  // namespace phat
