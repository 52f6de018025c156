// The incremental baker on its own thread, as the window has it.

#include "core/dynamic/baker_thread.h"

#include <cstdlib>
#include <thread>

#include "core/scene/default_camera.h"
#include "support/moving_room.h"

namespace phat {
namespace {

using namespace test;

/// What the window keeps: copies that know the updates alone.
struct Taker {
    Phatexture phatexture;
    std::vector<TexelState> states;
    size_t portions = 0;

    void take(BakerThread& light, const Atlas& atlas) {
        while (const auto update = light.take()) {
            applyUpdate(*update, atlas, phatexture, states);
            ++portions;
        }
    }
    void converge(BakerThread& light, const Atlas& atlas) {
        for (int i = 0; i < 60'000 && !light.report().converged; ++i) {
            take(light, atlas);
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        EXPECT_TRUE(light.report().converged);
        take(light, atlas);
    }
};

// PHAT_SOAK_MOVES makes it longer than the suite's moment; the thread and address sanitizers are meant to
// watch.
TEST(BakerThread, AfterAnyChangesAndBackItIsTheUntouchedBake) {
    const char* wanted = std::getenv("PHAT_SOAK_MOVES");
    const int moves = wanted ? std::atoi(wanted) : 150;
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    Taker taker{baked.phatexture, baked.points.state};
    std::atomic<int> woken = 0;
    PosedScene posed(scene);
    BakerThread light({posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake()}, 0,
                      [&] { ++woken; });
    Rng rng(3);
    const Camera eye = defaultCamera(scene);
    for (int i = 0; i < moves; ++i) {
        light.follow(posedAs(posed, randomState(scene, rng)), eye, rng.uniform() < 0.9f);
        std::this_thread::sleep_for(std::chrono::microseconds(int(10'000 * rng.uniform())));
        if (rng.uniform() < 0.7f) taker.take(light, baked.atlas);
        // However slow the machine, not all changes are overtaken by the next.
        const size_t before = taker.portions;
        for (int wait = 0; i % 20 == 19 && taker.portions == before && wait < 30'000; ++wait) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            taker.take(light, baked.atlas);
        }
        const BakerThread::Report report = light.report();
        EXPECT_LE(overall(report.upToDate), 1.0f);
    }
    light.follow(posedAs(posed, stateOf(scene)), eye, true);
    taker.converge(light, baked.atlas);
    EXPECT_GE(taker.portions, size_t(moves) / 20);
    EXPECT_GT(woken, 0);
    expectEqual(taker.phatexture, baked.phatexture);
    expectEqualBytes(taker.states, baked.points.state, "occluded texels");
    expectEqualBytes(taker.phatexture.tilePatches, baked.phatexture.tilePatches, "places");
}

// As while the light is switched off.
TEST(BakerThread, WhereLightWaitsTilesFollow) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    Taker taker{baked.phatexture, baked.points.state};
    PosedScene posed(scene);
    BakerThread light({posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake()}, 1, [] {});
    light.follow(posedAs(posed, boxMoved(scene, {0.3f, 0, 0.2f}, 20)), defaultCamera(scene), false);
    taker.converge(light, baked.atlas);
    size_t moved = 0;
    for (size_t t = 0; t < baked.phatexture.tilePatches.size(); ++t)
        moved += taker.phatexture.tilePatches[t] != baked.phatexture.tilePatches[t];
    EXPECT_GT(moved, 0u);
    EXPECT_EQ(light.report().phatexels, 0u);
    expectEqualBytes(taker.phatexture.indirectIrradiance, baked.phatexture.indirectIrradiance, "irradiance");
}

// A request waits by the clock, however little of that time the thread computes.
TEST(BakerThread, TheLongestStepIsMeasuredByTheClock) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    constexpr auto kPause = std::chrono::milliseconds(300);
    Taker taker{baked.phatexture, baked.points.state};
    PosedScene posed(scene);
    BakerThread light({posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake()}, 0,
                      [&] { std::this_thread::sleep_for(kPause); });
    light.follow(posedAs(posed, boxMoved(scene, {0.3f, 0, 0.2f}, 20)), defaultCamera(scene), false);
    taker.converge(light, baked.atlas);
    std::this_thread::sleep_for(2 * kPause);  // the last pause has been counted
    EXPECT_GE(light.report().longestSeconds, std::chrono::duration<double>(kPause).count());
}

TEST(BakerThread, StopsInTheMiddleOfItsWork) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    for (int i = 0; i < 5; ++i) {
        PosedScene posed(scene);
        BakerThread light({posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake()}, 0,
                          [] {});
        light.follow(posedAs(posed, boxMoved(scene, {0.3f, 0, 0.2f}, 20)), defaultCamera(scene), true);
        std::this_thread::sleep_for(std::chrono::milliseconds(20 * i));
    }
}

TEST(BakerThread, ReportsWhatCannotBeUpdated) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    BakeSettings settings = smallBake();
    settings.directions = Directions::photons;
    PosedScene posed(scene);
    BakerThread light({posed.snapshot(), baked.atlas, baked.points, baked.phatexture, settings}, 0, [] {});
    light.waitUntilStarted();
    EXPECT_THROW(light.take(), std::invalid_argument);
}

}  // namespace
}  // namespace phat
