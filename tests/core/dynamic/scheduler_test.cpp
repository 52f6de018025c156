// The order of work: what is visible and near a change first, and everything in bounded time.

#include "core/dynamic/scheduler.h"

#include "core/dynamic/map_updater.h"
#include "core/dynamic/urgency.h"
#include "core/scene/default_camera.h"
#include "support/moving_room.h"

namespace phat {
namespace {

using namespace test;

// The least and the greatest value of a tile: far from every change and outside the view, a quarter of a
// quarter; within a change's bounding sphere and in the view, 1 + 1/4.
constexpr float kLeast = 1.0f / 16, kGreatest = 1.25f;
// Of tiles that have moved.
constexpr float kBonus = 2;

struct SchedulerTest : testing::Test {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed{scene};
    BakerState state{posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake()};

    void makeAllStale() {
        state.scene.beginVersion();
        ++state.revision;
    }
    void moveBox() {
        ASSERT_TRUE(state.scene.set(posedAs(posed, boxMoved(scene, {0.3f, 0, 0.25f}, 30))));
        ++state.revision;
    }
    std::vector<uint32_t> orderOf(BakerTask task, const Camera* camera) const {
        return urgentFirst(state, task, tileValues(state, camera), false);
    }
    glm::vec3 normalOf(uint32_t tile) const {
        return state.scene.frames()[baked.atlas.blockAt(state.cornerOfTile(tile))].normal;
    }
    /// Half a tile's greatest extent, or more.
    float radiusOf(uint32_t tile) const {
        const TilePatch& patch = state.scene.patches()[tile];
        return 0.5f * float(kTileSize) * (glm::length(patch.alongX) + glm::length(patch.alongY));
    }
    bool moved(uint32_t tile) const {
        return state.scene.movedAt(baked.atlas.tileChart[tile]) > state.tileScene[tile];
    }
};

/// Expects all tiles of which `first` is true before all of which `last` is; returns how many were compared.
template <typename First, typename Last>
size_t expectBefore(const std::vector<uint32_t>& order, const First& first, const Last& last) {
    size_t firsts = 0, lasts = 0, wrong = 0;
    for (const uint32_t tile : order) {
        firsts += first(tile);
        wrong += first(tile) && lasts > 0;
        lasts += last(tile);
    }
    EXPECT_EQ(wrong, 0u) << "of " << firsts;
    return std::min(firsts, lasts);
}

TEST_F(SchedulerTest, VisibleTilesComeFirst) {
    Camera camera;  // in the middle of the room, toward its far side
    camera.worldFromCamera = glm::translate(glm::mat4(1), {0.5f, 0.5f, 0.5f});
    camera.yfovRadians = 1.2f;
    camera.aspect = 1;
    makeAllStale();
    const auto center = [&](uint32_t tile) { return state.scene.patches()[tile].center; };
    const float half = std::tan(0.6f);
    const auto visible = [&](uint32_t tile) {
        const glm::vec3 fromCamera = center(tile) - glm::vec3(0.5f);
        return fromCamera.z < 0 && std::abs(fromCamera.x) < -half * fromCamera.z &&
               std::abs(fromCamera.y) < -half * fromCamera.z && glm::dot(normalOf(tile), fromCamera) < 0;
    };
    const auto invisible = [&](uint32_t tile) {
        const glm::vec3 fromCamera = center(tile) - glm::vec3(0.5f);
        return fromCamera.z > radiusOf(tile) || glm::dot(normalOf(tile), fromCamera) > radiusOf(tile);
    };
    EXPECT_GT(expectBefore(orderOf(BakerTask::retraceInvalidated, &camera), visible, invisible), 20u);
}

TEST_F(SchedulerTest, TilesNearAChangeComeFirst) {
    moveBox();
    const std::vector<SceneChange> changes(state.scene.changes().begin(), state.scene.changes().end());
    ASSERT_EQ(changes.size(), 12u);  // six sides, at the old position and at the new one
    // Within the bounding sphere of a change the value is 1 + 1/4. From twice its radius on, the sphere
    // covers a quarter of the sky's half at most, and the value is 1/4 + 1/4 at most.
    const auto distanceInRadii = [&](uint32_t tile, const SceneChange& change) {
        return glm::length(change.box.center() - state.scene.patches()[tile].center) /
               (0.5f * change.box.diagonal());
    };
    const auto near = [&](uint32_t tile) {
        return std::any_of(changes.begin(), changes.end(), [&](const SceneChange& change) {
            const glm::vec3 toChange = change.box.center() - state.scene.patches()[tile].center;
            return !moved(tile) && distanceInRadii(tile, change) < 1 &&
                   glm::dot(toChange, normalOf(tile)) > 0;
        });
    };
    const auto far = [&](uint32_t tile) {
        return !moved(tile) && std::all_of(changes.begin(), changes.end(), [&](const SceneChange& change) {
            return distanceInRadii(tile, change) > 2;
        });
    };
    const std::vector<uint32_t> order = orderOf(BakerTask::retraceInvalidated, nullptr);
    EXPECT_GT(expectBefore(order, near, far), 2u);
    // The bonus of what has moved is more than the greatest difference of values.
    EXPECT_GT(
        expectBefore(
            order, [&](uint32_t tile) { return moved(tile); }, [&](uint32_t tile) { return !moved(tile); }),
        20u);
}

TEST_F(SchedulerTest, WhatIsOlderThanTheGreatestDifferenceOfValuesComesFirst) {
    moveBox();
    const Camera camera = defaultCamera(scene);
    const std::vector<uint32_t> order = orderOf(BakerTask::retraceInvalidated, &camera);
    const uint32_t last = order.back();
    ASSERT_FALSE(moved(last));
    // All others have just been updated; this one was so many passes ago.
    const auto firstIfOlderBy = [&](float passes) {
        state.clock = 10 * passWork(baked.atlas);
        state.tileClock.assign(state.tileClock.size(), state.clock);
        state.tileClock[last] = state.clock - uint64_t(double(passes) * double(passWork(baked.atlas)));
        return orderOf(BakerTask::retraceInvalidated, &camera).front() == last;
    };
    EXPECT_TRUE(firstIfOlderBy(kGreatest + kBonus - kLeast + 0.01f));
    // The first is a moved tile, whose value is 1/16 at least. So this is not old enough.
    EXPECT_FALSE(firstIfOlderBy(kBonus - kGreatest + kLeast));
}

// Goyal et al. 1996, theorem 1: while two tasks have work, what they have got over their weights differs by
// no more than a slice of each over its weight.
TEST(FairQueue, BusyTasksGetTheirSharesUpToASlice) {
    constexpr double kLongest = 200'000;  // slice
    FairQueue queue;
    Rng rng(5);
    std::array<double, kBakerTasks> served{};
    const auto run = [&](int slices, const std::array<bool, kBakerTasks>& busy) {
        served = {};
        for (int i = 0; i < slices; ++i) {
            const std::optional<BakerTask> task = queue.next(busy);
            ASSERT_TRUE(task && busy[size_t(*task)]);
            const uint64_t work = 1000 + uint64_t((kLongest - 1000) * rng.uniform());
            queue.charge(*task, work);
            served[size_t(*task)] += double(work) / taskWeight(*task);
            for (size_t a = 0; a < kBakerTasks; ++a)
                for (size_t b = 0; b < a; ++b) {
                    if (!busy[a] || !busy[b]) continue;
                    ASSERT_LE(std::abs(served[a] - served[b]),
                              kLongest / taskWeight(BakerTask(a)) + kLongest / taskWeight(BakerTask(b)));
                }
        }
    };
    std::array<bool, kBakerTasks> all;
    all.fill(true);
    run(2000, all);
    // Tasks that were idle for long get their shares from then on, and nothing of what they missed.
    std::array<bool, kBakerTasks> two{};
    two[size_t(BakerTask::photons)] = two[size_t(BakerTask::blocks)] = true;
    run(2000, two);
    run(2000, all);
    EXPECT_FALSE(queue.next({}));
}

/// The order in which the tasks come when each slice takes as much work.
std::vector<BakerTask> tasksOf(Scheduler& scheduler, BakerState& state) {
    std::vector<BakerTask> tasks;
    scheduler.replan(state, {});
    while (const std::optional<BakerTask> task = scheduler.takeTask({})) {
        EXPECT_FALSE(scheduler.takeItems(*task).empty());
        tasks.push_back(*task);
        scheduler.charge(*task, 1000, state.clock += 1000);
    }
    return tasks;
}

/// The index of the task's first and last slice.
std::pair<size_t, size_t> spanOf(const std::vector<BakerTask>& tasks, BakerTask task) {
    size_t first = tasks.size(), last = 0;
    for (size_t i = 0; i < tasks.size(); ++i) {
        if (tasks[i] != task) continue;
        first = std::min(first, i);
        last = i;
    }
    EXPECT_LT(first, tasks.size());
    return {first, last};
}

TEST_F(SchedulerTest, AfterTheLastChangeTasksWaitForTheirInputs) {
    MapUpdater maps(state);  // makes the nodes
    Scheduler scheduler;
    moveBox();
    EXPECT_FALSE(scheduler.isCurrent(state));
    scheduler.noteChange(state.clock);
    const std::vector<BakerTask> tasks = tasksOf(scheduler, state);
    EXPECT_TRUE(scheduler.isCurrent(state));
    EXPECT_LT(spanOf(tasks, BakerTask::areaLight).second, spanOf(tasks, BakerTask::nodes).first);
    EXPECT_LT(spanOf(tasks, BakerTask::nodes).second, spanOf(tasks, BakerTask::blocks).first);
    EXPECT_LT(spanOf(tasks, BakerTask::photons).second, spanOf(tasks, BakerTask::blocks).first);
    EXPECT_LT(spanOf(tasks, BakerTask::retraceInvalidated).first, spanOf(tasks, BakerTask::areaLight).second);
}

TEST_F(SchedulerTest, WhileChangesFollowEachOtherNoTaskWaits) {
    MapUpdater maps(state);
    Scheduler scheduler;
    moveBox();
    scheduler.noteChange(1);
    scheduler.noteChange(2);
    const std::vector<BakerTask> tasks = tasksOf(scheduler, state);
    EXPECT_GT(spanOf(tasks, BakerTask::areaLight).second, spanOf(tasks, BakerTask::nodes).first);
    EXPECT_GT(spanOf(tasks, BakerTask::photons).second, spanOf(tasks, BakerTask::blocks).first);
}

}  // namespace
}  // namespace phat
