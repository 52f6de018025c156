// The incremental baker against the bake, on a room with a box and lights.

#include "core/dynamic/incremental_baker.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "core/bake/bake.h"
#include "core/dynamic/urgency.h"
#include "core/phatexel/radiance_bound.h"
#include "core/scene/light_bound.h"
#include "support/moving_room.h"

namespace phat {
namespace {

using namespace test;

void converge(IncrementalBaker& engine) {
    SilentProgress progress;
    int rounds = 0;
    while (!engine.converged()) {
        engine.advance(1'000'000, progress);
        ASSERT_LT(++rounds, 1000);
    }
}

/// What a bake gathers for the scene as it is, on the engine's atlas.
Phatexture bakeOf(const DynamicScene& live) {
    SilentProgress progress;
    const BakeSettings settings = smallBake();
    const RayScene rays(live.scene());
    const LightSampler lights(live.scene());
    const PhotonMap photons = tracePhotons(rays, lights, settings.photons, progress);
    const PhotonIndex index(photons.photons);
    TexelPoints points = live.points();
    points.state = buildTexelPoints(live.scene(), live.atlas()).state;  // as if nothing were occluded
    markOccludedTexels(points, live.atlas(), rays, progress);
    const std::vector<uint8_t> wanted = irradianceTexels(live.atlas(), points);
    std::atomic<uint64_t> rayCount = 0;
    return gatherLight({{rays, lights, live.atlas(), points, live.frames(), photons, index, wanted},
                        settings,
                        progress,
                        nullptr,
                        rayCount});
}

TEST(IncrementalBaker, FromNothingItMakesTheBake) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, {}, smallBake());
    converge(engine);
    expectEqual(engine.phatexture(), baked.phatexture);
}

TEST(IncrementalBaker, AfterAMoveItIsTheBakeOfTheMovedScene) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
    ASSERT_TRUE(engine.setScene(posedAs(posed, boxMoved(scene, {0.3f, 0, 0.25f}, 30))));
    converge(engine);
    expectEqual(engine.phatexture(), bakeOf(engine.scene()));

    // And it is another light than before, or this would say nothing.
    size_t same = 0;
    const auto &now = engine.phatexture().indirect[0].texels, &before = baked.phatexture.indirect[0].texels;
    for (size_t i = 0; i < now.size(); ++i) same += std::memcmp(&now[i], &before[i], sizeof now[i]) == 0;
    EXPECT_LT(same, now.size() / 2);
}

TEST(IncrementalBaker, BackAtTheStartNothingIsLeftOfAMove) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
    SilentProgress progress;
    for (int i = 1; i <= 5; ++i) {
        engine.setScene(posedAs(posed, boxMoved(scene, {0.07f * float(i), 0, 0}, 10.0f * float(i))));
        engine.advance(300'000, progress);
    }
    SceneState dark = stateOf(scene);
    dark.lights.clear();
    dark.materials.back().emission = glm::vec3(0);
    dark.materials.front().baseColor = {0.1f, 0.1f, 0.9f, 1};
    ASSERT_TRUE(engine.setScene(posedAs(posed, dark)));
    converge(engine);
    for (const PackedPhatexel& packed : engine.phatexture().indirect[0].texels)
        ASSERT_EQ(packed.radiance, 0u);
    ASSERT_TRUE(engine.setScene(posedAs(posed, stateOf(scene))));
    EXPECT_FALSE(engine.setScene(posedAs(posed, stateOf(scene))));
    converge(engine);
    expectEqual(engine.phatexture(), baked.phatexture);
}

TEST(IncrementalBaker, LightsThatMoveLightWhatTheyMoveTo) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
    SceneState state = stateOf(scene);
    state.worldFromRest = {glm::mat4(1), glm::mat4(1), glm::translate(glm::mat4(1), {-0.2f, -0.1f, 0.1f})};
    state.lights[0].intensity = {0.1f, 0.1f, 0.6f};
    ASSERT_TRUE(engine.setScene(posedAs(posed, state)));
    EXPECT_EQ(engine.scene().scene().lights[0].position,
              scene.lights[0].position + glm::vec3(-0.2f, -0.1f, 0.1f));
    converge(engine);
    expectEqual(engine.phatexture(), bakeOf(engine.scene()));
}

// The first answer to a change is a small part of all the work, and after it no PHATexel holds what is no
// longer there.
TEST(IncrementalBaker, AtOnceEveryPhatexelIsAsFarAsItsRay) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
    converge(engine);
    const auto answer = [&]() -> const BakerStats::Task& {
        return engine.stats().tasks[size_t(BakerTask::retraceInvalidated)];
    };
    const BakerStats::Task before = answer();
    engine.drainUpdate();
    ASSERT_TRUE(engine.setScene(posedAs(posed, boxMoved(scene, {0.3f, 0, 0.25f}, 30))));
    SilentProgress progress;
    uint64_t work = 0, tiles = 0;
    for (const uint32_t chart : baked.atlas.tileChart) tiles += chart != kNoChart;
    while (answer().items < before.items + tiles) {
        work += engine.advance(1, progress);
        ASSERT_LT(answer().work - before.work, 1'000'000u);
        ASSERT_LT(work, 3'000'000u);  // with what goes on beside it
    }
    const TexelPoints& points = engine.scene().points();
    size_t wrong = 0, valid = 0;
    for (size_t i = 0; i < points.state.size(); ++i) {
        const Phatexel phatexel =
            unpackPhatexel(engine.phatexture().indirect[0].texels[i], baked.atlas.unitMeters);
        if (!phatexel.valid) continue;
        EXPECT_TRUE(points.valid(i));
        ++valid;
        const glm::uvec2 xy(i % baked.atlas.sizeTexels.x, i / baked.atlas.sizeTexels.x);
        const glm::vec3 direction =
            engine.scene().frames()[baked.atlas.blockAt(xy)].toWorld(phatexel.directionBlock);
        const Hit hit = engine.rays().closestHit(
            engine.rays().offsetOrigin(points.position[i], points.normal[i]), glm::normalize(direction));
        const float truth = hit ? hit.distance : kFarDistance;
        wrong +=
            std::abs(std::log(phatexel.distance / truth)) > 0.06f;  // half a code, and the origin's offset
    }
    EXPECT_GT(valid, 10'000u);
    EXPECT_LT(double(wrong) / double(valid), 2e-3);  // rays along edges
}

// Bytes on the way, not only at the end.
TEST(IncrementalBaker, SameBytesOnAnyNumberOfThreads) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    std::vector<Phatexture> results;
    std::vector<size_t> sent;
    for (const int threads : {1, 2, 8}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, size_t(threads));
        PosedScene posed(scene);
        IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
        SilentProgress progress;
        size_t tiles = 0;
        for (int i = 0; i < 6; ++i) {
            engine.setScene(posedAs(posed, boxMoved(scene, {0.05f * float(i), 0, 0}, 15.0f * float(i))));
            engine.advance(500'000, progress);
            tiles += engine.drainUpdate().phatexels.size();
        }
        results.push_back(engine.phatexture());
        sent.push_back(tiles);
    }
    EXPECT_GT(sent[0], 100u);
    for (size_t i = 1; i < results.size(); ++i) {
        expectEqual(results[0], results[i]);
        EXPECT_EQ(sent[0], sent[i]);
    }
}

// A drawing side that knows nothing but the updates has the same PHATexels.
TEST(IncrementalBaker, UpdatesAreComplete) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
    Phatexture drawn = baked.phatexture;
    const uint32_t width = baked.atlas.sizeTexels.x;
    std::vector<TexelState> states = baked.points.state;
    SilentProgress progress;
    for (int step = 0; step < 8; ++step) {
        engine.setScene(
            posedAs(posed, boxMoved(scene, {0.05f * float(step % 5), 0, 0}, 15.0f * float(step))));
        engine.advance(400'000, progress);
        applyUpdate(engine.drainUpdate(), baked.atlas, drawn, states);
        // Invalid texels and those without a chart may keep what they had.
        size_t different = 0;
        for (size_t i = 0; i < drawn.indirect[0].texels.size(); ++i)
            if (baked.atlas.chartAt({i % width, i / width}) != kNoChart)
                different += drawn.indirectIrradiance[i] != engine.phatexture().indirectIrradiance[i];
        EXPECT_EQ(different, 0u);
        drawn.indirectIrradiance = engine.phatexture().indirectIrradiance;
        drawn.areaIrradiance = engine.phatexture().areaIrradiance;
        expectEqual(drawn, engine.phatexture());
        expectEqualBytes(drawn.tilePatches, engine.phatexture().tilePatches, "places");
        expectEqualBytes(states, engine.scene().points().state, "occluded texels");
    }
    EXPECT_TRUE(engine.drainUpdate().empty());
}

// What PHATexels held before a change must not hold down the irradiance after it.
TEST(IncrementalBaker, OnlyPresentPhatexelsBoundLight) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
    ASSERT_TRUE(engine.setScene(posedAs(posed, boxMoved(scene, {0.3f, 0, 0.25f}, 30))));
    const std::vector<glm::vec4> atOnce = engine.drainUpdate().tileLight;
    ASSERT_EQ(atOnce.size(), baked.atlas.tileChart.size());
    for (size_t tile = 0; tile < atOnce.size(); ++tile) {
        if (baked.atlas.tileChart[tile] == kNoChart) continue;
        ASSERT_EQ(glm::vec3(atOnce[tile]), glm::vec3(kUnbounded));
    }

    converge(engine);
    const std::vector<glm::vec4> converged = engine.drainUpdate().tileLight;
    EXPECT_EQ(converged, tileLight(engine.scene().scene(), baked.atlas, engine.phatexture()));
    size_t bounded = 0;
    for (const glm::vec4& light : converged) bounded += light.r > 0 && light.r < kUnbounded;
    EXPECT_GT(bounded, converged.size() / 4);
}

/// The most work of one slice of each task, and more at times: of one short advance.
struct LongestSlices {
    std::array<double, kBakerTasks> work{};

    void advance(IncrementalBaker& baker, uint64_t amount) {
        SilentProgress progress;
        const BakerStats before = baker.stats();
        baker.advance(amount, progress);
        for (size_t t = 0; t < kBakerTasks; ++t)
            work[t] = std::max(work[t], double(baker.stats().tasks[t].work - before.tasks[t].work));
    }

    /// The most work after which a task that always had something to do has done `amount`. source: Goyal et
    /// al. 1996, theorem 2: it gets its share, less a slice of its own and the share of a slice of each
    /// other.
    double workUntil(BakerTask task, double amount) const {
        double weights = 0, slices = 0;
        for (size_t t = 0; t < kBakerTasks; ++t) {
            weights += taskWeight(BakerTask(t));
            slices += work[t];
        }
        return (amount + work[size_t(task)]) * weights / taskWeight(task) + slices;
    }
};

// With a new scene at every step nothing ever converges, but nothing is forgotten either.
//
// A block's urgency is its value, which is at most 1 more than that of another, plus its age in passes. So
// once it waits for a pass, each other block comes before it once at most: one that was updated since then is
// younger by more than a pass. After a pass and the time of updating every block once it has been updated.
TEST(IncrementalBaker, NoBlockGetsOldWhileEverythingMoves) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
    std::vector<int> updated(baked.atlas.blockCount, 0);
    int oldest = 0;
    constexpr int kSteps = 100, kPartsOfStep = 60;
    constexpr uint64_t kStepWork = 600'000;
    LongestSlices slices;
    for (int step = 1; step <= kSteps; ++step) {
        engine.setScene(posedAs(
            posed, boxMoved(scene, {0.2f + 0.2f * std::sin(0.3f * float(step)), 0, 0}, 5.0f * float(step))));
        for (int i = 0; i < kPartsOfStep; ++i) slices.advance(engine, kStepWork / kPartsOfStep);
        for (const LightUpdate::Guides& guides : engine.drainUpdate().guides) {
            oldest = std::max(oldest, step - updated[guides.block]);
            updated[guides.block] = step;
        }
    }
    for (const int last : updated) oldest = std::max(oldest, kSteps - last);
    constexpr uint32_t kBlocksPerSlice = 8;
    const double all = slices.work[size_t(BakerTask::blocks)] *
                       ((baked.atlas.blockCount + kBlocksPerSlice - 1) / kBlocksPerSlice);
    const double work = double(passWork(baked.atlas)) + slices.workUntil(BakerTask::blocks, all);
    // Of steps, the first has no blocks yet, since nothing is in motion before the second change; the last
    // may have begun with what a slice of the step before took too much.
    const double bound = 2 + work / double(kStepWork);
    EXPECT_LE(oldest, bound);
    EXPECT_LT(bound, kSteps);  // or this would say nothing
    // Maps of all, and those of the box alone.
    EXPECT_GE(engine.stats().indirectMaps.items, 3u);
    EXPECT_GT(engine.stats().areaMaps.items, 15u);
    EXPECT_GT(engine.stats().tasks[size_t(BakerTask::moved)].items, uint64_t(kSteps) / 2);
}

// Moves, removals to the far end, lights switched, changed materials: whatever was begun and not finished,
// nothing of it is left.
TEST(IncrementalBaker, RandomChangesLeaveNothingBehind) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
    SilentProgress progress;
    Rng rng(7);
    constexpr int kChanges = 40;
    for (int i = 0; i < kChanges; ++i) {
        engine.setScene(posedAs(posed, randomState(scene, rng)));
        engine.advance(uint64_t(300'000 * rng.uniform()), progress);
        if (rng.uniform() < 0.5f) engine.drainUpdate();
    }
    engine.setScene(posedAs(posed, stateOf(scene)));
    converge(engine);
    expectEqual(engine.phatexture(), baked.phatexture);
}

TEST(IncrementalBaker, RaysPassThroughWhatHasBeenCutAway) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
    ASSERT_TRUE(engine.setScene(posedAs(posed, boxMoved(scene, {0.1f, 0, 0}, 0))));

    // Rays pass through the box as soon as its surfaces are cut away, and meet it again afterwards.
    const glm::vec3 origin(0.6f, 0.9f, 0.3f), target(0.425f, 0.3f, 0.3f);
    const glm::vec3 down = glm::normalize(target - origin);
    const float onBox = engine.rays().closestHit(origin, down).distance;
    SceneState state = boxMoved(scene, {0.1f, 0, 0}, 0);
    for (const Surface& surface : scene.surfaces)
        if (surface.node == kBoxNode) {
            state.materials[surface.material].alphaMode = AlphaMode::mask;
            state.materials[surface.material].baseColor.a = 0;
        }
    ASSERT_TRUE(engine.setScene(posedAs(posed, state)));
    EXPECT_GT(engine.rays().closestHit(origin, down).distance, onBox + 0.1f);
    ASSERT_TRUE(engine.setScene(posedAs(posed, boxMoved(scene, {0.1f, 0, 0}, 0))));
    EXPECT_EQ(engine.rays().closestHit(origin, down).distance, onBox);
}

TEST(IncrementalBaker, AChangedLightIsAnsweredBeforeAnyBlockIsUpdated) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
    converge(engine);
    const BakerStats before = engine.stats();
    SceneState state = stateOf(scene);
    state.lights[0].intensity *= 4.0f;
    ASSERT_TRUE(engine.setScene(posedAs(posed, state)));
    SilentProgress progress;
    const auto itemsOf = [&](BakerTask task) {
        return engine.stats().tasks[size_t(task)].items - before.tasks[size_t(task)].items;
    };
    const auto tiles = uint64_t(std::count_if(baked.atlas.tileChart.begin(), baked.atlas.tileChart.end(),
                                              [](uint32_t chart) { return chart != kNoChart; }));
    while (itemsOf(BakerTask::retraceInvalidated) < tiles) engine.advance(1, progress);
    EXPECT_EQ(itemsOf(BakerTask::blocks), 0u);
    size_t valid = 0, brighter = 0;
    const auto &now = engine.phatexture().indirect[0].texels, &was = baked.phatexture.indirect[0].texels;
    for (size_t i = 0; i < now.size(); ++i) {
        const Phatexel a = unpackPhatexel(was[i], 1), b = unpackPhatexel(now[i], 1);
        if (!a.valid || !b.valid || luminance(a.radiance) == 0) continue;
        ++valid;
        brighter += luminance(b.radiance) > 1.2f * luminance(a.radiance);
    }
    EXPECT_GT(valid, 10'000u);
    EXPECT_GT(brighter, valid / 2);
    converge(engine);
    expectEqual(engine.phatexture(), bakeOf(engine.scene()));
}

TEST(IncrementalBaker, RefinesOnlyWhatHasConverged) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
    EXPECT_DEBUG_DEATH(engine.refine(), "converged");
}

TEST(IncrementalBaker, SinglePhotonsCannotBeUpdated) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    BakeSettings settings = smallBake();
    settings.directions = Directions::photons;
    EXPECT_THROW(
        IncrementalBaker(PosedScene(scene).snapshot(), baked.atlas, baked.points, baked.phatexture, settings),
        std::invalid_argument);
}

}  // namespace
}  // namespace phat
