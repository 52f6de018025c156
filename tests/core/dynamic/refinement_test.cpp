// Light of a still scene that is made anew with other random numbers.

#include "core/base/octahedral.h"
#include "core/dynamic/baker_thread.h"
#include "core/dynamic/incremental_baker.h"
#include "core/scene/default_camera.h"
#include "support/moving_room.h"

namespace phat {
namespace {

using namespace test;

void converge(IncrementalBaker& engine) {
    SilentProgress progress;
    for (int rounds = 0; !engine.converged(); ++rounds) {
        engine.advance(1'000'000, progress);
        ASSERT_LT(rounds, 1000);
    }
}

Phatexture refined(const Scene& scene, const Bake& baked, uint64_t seed, int passes) {
    BakeSettings settings = smallBake();
    settings.seed = settings.photons.seed = seed;
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, {}, settings);
    converge(engine);
    for (int i = 0; i < passes; ++i) {
        engine.refine();
        converge(engine);
    }
    EXPECT_EQ(engine.passes(), uint32_t(passes));
    return engine.phatexture();
}

double meanDifference(const Bake& baked, const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
    double sum = 0, mean = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        if (!baked.points.valid(i)) continue;
        sum += std::abs(luminance(unpackRgb9e5(a[i])) - luminance(unpackRgb9e5(b[i])));
        mean += luminance(unpackRgb9e5(a[i]));
    }
    return sum / mean;
}

// What two bakes of other seeds disagree about is noise, and it falls.
TEST(Refinement, IrradianceOfAllPassesHasLessNoiseThanABake) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    const Phatexture a1 = refined(scene, baked, 1, 0), b1 = refined(scene, baked, 2, 0);
    const Phatexture a4 = refined(scene, baked, 1, 3), b4 = refined(scene, baked, 2, 3);
    // Four independent ones would disagree by half as much; some of the rest is the rounding to RGB9E5.
    EXPECT_LT(meanDifference(baked, a4.indirectIrradiance, b4.indirectIrradiance),
              0.65 * meanDifference(baked, a1.indirectIrradiance, b1.indirectIrradiance));
    EXPECT_LT(meanDifference(baked, a4.areaIrradiance, b4.areaIrradiance),
              0.65 * meanDifference(baked, a1.areaIrradiance, b1.areaIrradiance));
}

TEST(Refinement, EveryPassHasOtherDirectionsInALayoutOfTheirOwn) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
    converge(engine);
    Phatexture drawn = baked.phatexture;
    std::vector<TexelState> states = baked.points.state;
    const LightUpdate first = engine.drainUpdate();
    EXPECT_FALSE(first.refined);
    applyUpdate(first, baked.atlas, drawn, states);
    engine.refine();
    converge(engine);
    const LightUpdate update = engine.drainUpdate();
    EXPECT_TRUE(update.refined);
    applyUpdate(update, baked.atlas, drawn, states);
    expectEqual(drawn, engine.phatexture());
    expectEqualBytes(drawn.tilePatches, engine.phatexture().tilePatches, "places");
    const auto &was = baked.phatexture.indirect[0], &now = engine.phatexture().indirect[0];
    expectEqualBytes(drawn.indirect[0].scrambles, now.scrambles, "scrambles");
    expectEqualBytes(drawn.area[0].scrambles, engine.phatexture().area[0].scrambles, "area scrambles");
    size_t sameBlocks = 0, sameTexels = 0, valid = 0;
    for (size_t b = 0; b < now.scrambles.size(); ++b) sameBlocks += now.scrambles[b] == was.scrambles[b];
    EXPECT_LT(sameBlocks, 1 + now.scrambles.size() / 20);
    for (size_t i = 0; i < now.texels.size(); ++i) {
        if (now.texels[i].directionDistance == 0) continue;
        ++valid;
        sameTexels += now.texels[i].directionDistance == was.texels[i].directionDistance;
    }
    EXPECT_GT(valid, 10'000u);
    EXPECT_LT(sameTexels, valid / 50);
}

// A change in the middle of a pass, whose answer is in the layouts of both passes.
TEST(Refinement, AChangeEndsItAndNothingIsLeftOfIt) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    IncrementalBaker engine(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake());
    converge(engine);
    SilentProgress progress;
    for (const uint64_t work : {500'000u, 2'000'000u, 4'000'000u}) {
        engine.refine();
        engine.advance(work, progress);
        ASSERT_TRUE(engine.setScene(posedAs(posed, boxMoved(scene, {0.2f, 0, 0.1f}, 20))));
        EXPECT_EQ(engine.passes(), 0u);
        engine.advance(work, progress);
        ASSERT_TRUE(engine.setScene(posedAs(posed, stateOf(scene))));
        EXPECT_FALSE(engine.drainUpdate().refined);
        converge(engine);
        engine.drainUpdate();
        expectEqual(engine.phatexture(), baked.phatexture);
        expectEqualBytes(engine.phatexture().indirect[0].scrambles, baked.phatexture.indirect[0].scrambles,
                         "scrambles");
    }
}

TEST(Refinement, GoesOnWhileItIsWanted) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    PosedScene posed(scene);
    BakerThread light({posed.snapshot(), baked.atlas, baked.points, baked.phatexture, smallBake()}, 0, [] {});
    const auto takeUntil = [&](const auto& reached) {
        for (int i = 0; i < 60'000 && !reached(light.report()); ++i) {
            light.take();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        EXPECT_TRUE(reached(light.report()));
    };
    light.follow(posedAs(posed, stateOf(scene)), defaultCamera(scene), true, true);
    takeUntil([](const BakerThread::Report& report) { return report.refinements >= 2; });
    EXPECT_FALSE(light.report().converged);
    // It is not wanted any more: it rests at once, in the middle of a pass.
    light.follow(posedAs(posed, stateOf(scene)), defaultCamera(scene), true, false);
    takeUntil([](const BakerThread::Report& report) { return report.converged; });
    const double before = light.report().seconds;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_EQ(light.report().seconds, before);
    light.follow(posedAs(posed, boxMoved(scene, {0.2f, 0, 0.1f}, 20)), defaultCamera(scene), true, false);
    takeUntil([](const BakerThread::Report& report) { return report.converged; });
    EXPECT_EQ(light.report().refinements, 0u);
}

}  // namespace
}  // namespace phat
