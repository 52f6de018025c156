#include "core/dynamic/scheduler.h"

#include "core/base/parallel.h"

namespace phat {
namespace {

// Before the last so many boxes changes are no longer news.
constexpr size_t kRecentChanges = 16;
// Of what nobody sees: it still lights what is seen.
constexpr float kUnseen = 0.25f;
// Of tiles far from any change, so that the eye decides among them.
constexpr float kLeastValue = 0.25f;

// What has moved carries light of its old place along: before all that is not twice as old as a pass.
constexpr float kMovedBonus = 2.0f;

// Shares of the work, by BakerTask. Irradiance of what has moved is little work and plainly out of place
// until then; responding to a change is soon done, too. A map that is begun keeps nearly all else waiting.
// Blocks that are renewed before the light around them is known have to be renewed again.
constexpr double kShare[kBakerTasks] = {100, 16, 2, 12, 4, 20, 4};

bool isSeen(const Camera& eye, const TilePatch& patch, glm::vec3 normal, float radius) {
    const glm::mat4 cameraFromWorld = glm::inverse(eye.worldFromCamera);
    const glm::vec3 p = cameraFromWorld * glm::vec4(patch.center, 1.0f);
    const float aspect = eye.aspect > 0 ? eye.aspect : 16.0f / 9;
    if (!eye.perspective)
        return std::abs(p.y) < eye.ymag + radius && std::abs(p.x) < eye.ymag * aspect + radius;
    if (p.z > radius) return false;
    const glm::vec3 towardEye = glm::vec3(eye.worldFromCamera[3]) - patch.center;
    if (glm::dot(towardEye, normal) < -radius) return false;
    const float half = std::tan(0.5f * eye.yfovRadians);
    return std::abs(p.y) < -p.z * half + 2 * radius && std::abs(p.x) < -p.z * half * aspect + 2 * radius;
}

}  // namespace

std::vector<float> tileValues(const BakerState& state, const Camera* eye) {
    const Atlas& atlas = state.scene.atlas();
    const std::span<const SceneChange> changes = state.scene.changes();
    const std::span<const SceneChange> recent = changes.last(std::min(changes.size(), kRecentChanges));
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
                const glm::vec3 way = change.box.center() - patch.center;
                if (glm::dot(way, normal) < -radius) continue;  // behind
                // The box's sphere as it is seen, against half the sky.
                value = std::max(value, square(radius) / std::max(glm::dot(way, way), square(radius)));
            }
            const float radius =
                0.5f * float(kTileSize) * (glm::length(patch.alongX) + glm::length(patch.alongY));
            values[tile] =
                (value + kLeastValue) * (!eye || isSeen(*eye, patch, normal, radius) ? 1.0f : kUnseen);
        }
    });
    return values;
}

std::vector<uint32_t> urgentFirst(const BakerState& state, BakerTask task,
                                  const std::vector<float>& tileValue, uint64_t clock, uint64_t passClock) {
    const Atlas& atlas = state.scene.atlas();
    const uint64_t version = state.scene.version();
    struct Item {
        float urgency;
        uint32_t index;
    };
    std::vector<Item> items;
    const auto add = [&](uint32_t index, float value, uint64_t renewed) {
        items.push_back({value + float(double(clock - renewed) / double(passClock)), index});
    };
    const auto valueIn = [&](glm::uvec2 corner, glm::uvec2 size) {
        float value = 0;
        for (uint32_t y = corner.y / kTileSize; y < (corner.y + size.y) / kTileSize; ++y)
            for (uint32_t x = corner.x / kTileSize; x < (corner.x + size.x) / kTileSize; ++x)
                value = std::max(value, tileValue[size_t(y) * atlas.sizeTiles().x + x]);
        return value;
    };
    const auto hasMoved = [&](uint32_t tile) {
        return state.scene.movedAt(atlas.tileChart[tile]) > state.tileScene[tile];
    };
    const bool areaKnown = std::all_of(state.regionScene.begin(), state.regionScene.end(),
                                       [&](uint64_t scene) { return scene == version; });
    switch (task) {
        case BakerTask::retraceInvalidated:
            for (uint32_t t = 0; t < tileValue.size(); ++t)
                if (atlas.tileChart[t] != kNoChart && state.tileScene[t] < version)
                    add(t, tileValue[t] + (hasMoved(t) ? kMovedBonus : 0.0f), state.tileClock[t]);
            break;
        case BakerTask::photons:
            for (uint32_t p = 0; p < state.photonsScene.size(); ++p)
                if (state.photonsScene[p] < version)
                    items.push_back({float(version - state.photonsScene[p]), p});
            break;
        case BakerTask::areaLight: {
            const uint32_t wide = (atlas.sizeTexels.x + kBlockSize - 1) / kBlockSize;
            for (uint32_t r = 0; r < state.regionScene.size(); ++r) {
                if (state.regionScene[r] == version) continue;
                const glm::uvec2 corner = glm::uvec2(r % wide, r / wide) * kBlockSize;
                const glm::uvec2 size = glm::min(glm::uvec2(kBlockSize), atlas.sizeTexels - corner);
                add(r, valueIn(corner, size), state.regionClock[r]);
            }
            break;
        }
        case BakerTask::nodes:
            for (uint32_t n = 0; n < state.nodes.size(); ++n) {
                const NodeAge& age = state.nodeAge[n];
                if (age.scene == version && (!areaKnown || age.area == state.areaVersion)) continue;
                const uint32_t width = atlas.sizeTexels.x;
                const glm::uvec2 tile =
                    glm::uvec2(state.level.texel[n] % width, state.level.texel[n] / width) / kTileSize;
                const uint32_t index = tile.y * atlas.sizeTiles().x + tile.x;
                add(n, tileValue[index] + float(age.scene == 0), age.clock);
            }
            break;
        case BakerTask::moved:  // they have no items
        case BakerTask::maps:
            break;
        case BakerTask::blocks: {
            const bool photonsKnown = state.photonsVersion() == version;
            for (uint32_t b = 0; b < state.blockAge.size(); ++b) {
                const BlockAge& age = state.blockAge[b];
                if (age.scene == version && (!photonsKnown || age.photons == version) &&
                    (!state.irradianceKnown || age.irradiance == state.irradianceVersion))
                    continue;
                add(b, valueIn(state.blocks[b].origin, state.blocks[b].size), age.clock);
            }
            break;
        }
    }
    // Equal urgency: in the order of the atlas.
    std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) {
        return a.urgency != b.urgency ? a.urgency > b.urgency : a.index < b.index;
    });
    std::vector<uint32_t> order;
    order.reserve(items.size());
    for (const Item& item : items) order.push_back(item.index);
    return order;
}

std::optional<BakerTask> FairQueue::next(const std::array<bool, kBakerTasks>& hasWork) {
    std::optional<size_t> best;
    for (size_t t = 0; t < kBakerTasks; ++t) {
        // Who was idle has no claim on what it missed.
        if (hasWork[t] && !busy_[t]) served_[t] = std::max(served_[t], now_);
        busy_[t] = hasWork[t];
        if (hasWork[t] && (!best || served_[t] < served_[*best])) best = t;
    }
    if (!best) return std::nullopt;
    now_ = served_[*best];
    return BakerTask(*best);
}

void FairQueue::done(BakerTask task, uint64_t work) {
    served_[size_t(task)] += double(work) / kShare[size_t(task)];
}

}  // namespace phat
