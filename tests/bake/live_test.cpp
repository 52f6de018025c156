// The live update engine against the bake, on a room with a box and lamps.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

#include "core/bake.h"
#include "core/live_engine.h"
#include "scene_builder.h"

namespace phat {
namespace {

using namespace test;

constexpr uint32_t kBoxNode = 1, kLampNode = 2;

// A room, a coloured box on its floor, a lamp's panel and a point light.
Scene roomWithBox() {
    Scene scene;
    addRoom(scene, lambert(0.6f), {1, 1, 1});
    scene.materials[0].baseColor = {0.8f, 0.2f, 0.2f, 1};
    Material metal = lambert(0.7f);
    metal.metallic = 1;
    metal.roughness = 0.4f;
    scene.materials[scene.surfaces[2].material] = metal;  // the floor
    const size_t room = scene.surfaces.size();
    const glm::vec3 low(0.2f, 0, 0.2f), high(0.45f, 0.3f, 0.4f);
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 along(0), across(0), far = low;
        along[(axis + 1) % 3] = high[(axis + 1) % 3] - low[(axis + 1) % 3];
        across[(axis + 2) % 3] = high[(axis + 2) % 3] - low[(axis + 2) % 3];
        far[axis] = high[axis];
        addQuad(scene, lambert(0.5f), low, across, along);
        addQuad(scene, lambert(0.5f), far, along, across);
    }
    for (size_t s = room; s < scene.surfaces.size(); ++s) {
        scene.surfaces[s].node = kBoxNode;
        scene.materials[scene.surfaces[s].material].baseColor = {0.2f, 0.7f, 0.3f, 1};
    }
    addQuad(scene, emitter(glm::vec3(4), 0.5f), {0.3f, 0.98f, 0.3f}, {0.4f, 0, 0}, {0, 0, 0.4f});
    scene.surfaces.back().node = kLampNode;
    scene.lights = {pointLight(glm::vec3(0.3f), {0.7f, 0.6f, 0.6f})};
    scene.lights[0].node = kLampNode;
    return scene;
}

BakeSettings smallBake() {
    BakeSettings settings;
    settings.atlas.texelBudget = 30'000;
    settings.photons.count = 20'000;
    settings.pathsPerPhatexel = 2;
    return settings;
}

Bake bakeQuietly(const Scene& scene) {
    SilentProgress progress;
    return bake(scene, smallBake(), progress);
}

LivePose poseOf(const Scene& scene) {
    return {{}, scene.lights, scene.materials};
}

LivePose boxMoved(const Scene& scene, glm::vec3 by, float degrees) {
    LivePose pose = poseOf(scene);
    const glm::vec3 middle(0.325f, 0, 0.3f);
    glm::mat4 m = glm::translate(glm::mat4(1), by + middle);
    m = glm::rotate(m, glm::radians(degrees), glm::vec3(0, 1, 0));
    pose.worldFromRest = {glm::mat4(1), glm::translate(m, -middle)};
    return pose;
}

void settle(LiveEngine& engine) {
    SilentProgress progress;
    int rounds = 0;
    while (!engine.settled()) {
        engine.advance(1'000'000, progress);
        ASSERT_LT(++rounds, 1000);
    }
}

template <typename Value>
void expectEqualBytes(const std::vector<Value>& a, const std::vector<Value>& b, const char* what) {
    ASSERT_EQ(a.size(), b.size()) << what;
    size_t different = 0;
    for (size_t i = 0; i < a.size(); ++i) different += std::memcmp(&a[i], &b[i], sizeof(Value)) != 0;
    EXPECT_EQ(different, 0u) << what << " of " << a.size();
}

void expectEqual(const Phatexture& a, const Phatexture& b) {
    expectEqualBytes(a.areaIrradiance, b.areaIrradiance, "area irradiance");
    expectEqualBytes(a.indirectIrradiance, b.indirectIrradiance, "indirect irradiance");
    expectEqualBytes(a.indirectGuides, b.indirectGuides, "guides");
    expectEqualBytes(a.areaGuides, b.areaGuides, "area guides");
    expectEqualBytes(a.probes, b.probes, "distances");
    ASSERT_EQ(a.indirect.size(), b.indirect.size());
    for (size_t l = 0; l < a.indirect.size(); ++l)
        expectEqualBytes(a.indirect[l].texels, b.indirect[l].texels, "PHATexels");
    ASSERT_EQ(a.area.size(), b.area.size());
    for (size_t l = 0; l < a.area.size(); ++l)
        expectEqualBytes(a.area[l].texels, b.area[l].texels, "area PHATexels");
}

/// What a bake gathers for the scene as it is, on the engine's atlas.
Phatexture bakeOf(const LiveScene& live) {
    SilentProgress progress;
    const BakeSettings settings = smallBake();
    const RayScene rays(live.scene());
    const LightSampler lights(live.scene());
    const PhotonMap photons = tracePhotons(rays, lights, settings.photons, progress);
    const PhotonIndex index(photons.photons);
    TexelPoints points = live.points();
    for (size_t i = 0; i < points.state.size(); ++i) points.state[i] = live.restState(i);
    markCoveredTexels(points, live.atlas(), rays, progress);
    const std::vector<uint8_t> wanted = irradianceTexels(live.atlas(), points);
    std::atomic<uint64_t> rayCount = 0;
    return gatherLight({rays, lights, live.atlas(), points, live.frames(), photons, index, wanted}, settings,
                       progress, nullptr, rayCount);
}

TEST(Live, FromNothingItMakesTheBake) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    LiveEngine engine(scene, baked.atlas, baked.points, {}, smallBake());
    settle(engine);
    expectEqual(engine.phatexture(), baked.phatexture);
}

TEST(Live, AfterAMoveItIsTheBakeOfTheMovedScene) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    LiveEngine engine(scene, baked.atlas, baked.points, baked.phatexture, smallBake());
    ASSERT_TRUE(engine.setPose(boxMoved(scene, {0.3f, 0, 0.25f}, 30)));
    settle(engine);
    expectEqual(engine.phatexture(), bakeOf(engine.scene()));

    // And it is another light than before, or this would say nothing.
    size_t same = 0;
    const auto &now = engine.phatexture().indirect[0].texels, &before = baked.phatexture.indirect[0].texels;
    for (size_t i = 0; i < now.size(); ++i) same += std::memcmp(&now[i], &before[i], sizeof now[i]) == 0;
    EXPECT_LT(same, now.size() / 2);
}

TEST(Live, BackAtTheStartNothingIsLeftOfAMove) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    LiveEngine engine(scene, baked.atlas, baked.points, baked.phatexture, smallBake());
    SilentProgress progress;
    for (int i = 1; i <= 5; ++i) {
        engine.setPose(boxMoved(scene, {0.07f * float(i), 0, 0}, 10.0f * float(i)));
        engine.advance(300'000, progress);
    }
    LivePose dark = poseOf(scene);
    dark.lights.clear();
    dark.materials.back().emission = glm::vec3(0);
    dark.materials.front().baseColor = {0.1f, 0.1f, 0.9f, 1};
    ASSERT_TRUE(engine.setPose(dark));
    settle(engine);
    for (const PackedPhatexel& packed : engine.phatexture().indirect[0].texels)
        ASSERT_EQ(packed.radiance, 0u);
    ASSERT_TRUE(engine.setPose(poseOf(scene)));
    EXPECT_FALSE(engine.setPose(poseOf(scene)));
    settle(engine);
    expectEqual(engine.phatexture(), baked.phatexture);
}

TEST(Live, LampsThatMoveLightWhatTheyMoveTo) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    LiveEngine engine(scene, baked.atlas, baked.points, baked.phatexture, smallBake());
    LivePose pose = poseOf(scene);
    pose.worldFromRest = {glm::mat4(1), glm::mat4(1), glm::translate(glm::mat4(1), {-0.2f, -0.1f, 0.1f})};
    pose.lights[0].intensity = {0.1f, 0.1f, 0.6f};
    ASSERT_TRUE(engine.setPose(pose));
    EXPECT_EQ(engine.scene().scene().lights[0].position,
              scene.lights[0].position + glm::vec3(-0.2f, -0.1f, 0.1f));
    settle(engine);
    expectEqual(engine.phatexture(), bakeOf(engine.scene()));
}

// The first answer to a change is a small part of all the work, and after it no PHATexel sees a ghost.
TEST(Live, AtOnceEveryPhatexelIsAsFarAsItsRay) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    LiveEngine engine(scene, baked.atlas, baked.points, baked.phatexture, smallBake());
    settle(engine);
    const uint64_t before = engine.stats().tasks[0].items;
    engine.takeUpdate();
    ASSERT_TRUE(engine.setPose(boxMoved(scene, {0.3f, 0, 0.25f}, 30)));
    SilentProgress progress;
    uint64_t work = 0, tiles = 0;
    for (const uint32_t chart : baked.atlas.tileChart) tiles += chart != kNoChart;
    while (engine.stats().tasks[0].items < before + tiles) {
        work += engine.advance(1, progress);
        ASSERT_LT(work, 2'000'000u);
    }
    const TexelPoints& points = engine.scene().points();
    size_t wrong = 0, valid = 0;
    for (size_t i = 0; i < points.state.size(); ++i) {
        const Phatexel phatexel = unpackPhatexel(engine.phatexture().indirect[0].texels[i]);
        if (!phatexel.valid) continue;
        EXPECT_TRUE(points.valid(i));
        ++valid;
        const glm::uvec2 xy(i % baked.atlas.sizeTexels.x, i / baked.atlas.sizeTexels.x);
        const glm::vec3 direction =
            engine.scene().frames()[baked.atlas.blockAt(xy)].toWorld(phatexel.directionBlock);
        const Hit hit = engine.rays().closestHit(offsetOrigin(points.position[i], points.normal[i]),
                                                 glm::normalize(direction));
        const float truth = hit ? hit.distance : kFarDistance;
        wrong +=
            std::abs(std::log(phatexel.distance / truth)) > 0.06f;  // half a code, and the origin's offset
    }
    EXPECT_GT(valid, 10'000u);
    EXPECT_LT(double(wrong) / double(valid), 2e-3);  // rays along edges
}

// Bytes on the way, not only at the end.
TEST(Live, SameBytesOnAnyNumberOfThreads) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    std::vector<Phatexture> results;
    std::vector<size_t> sent;
    for (const int threads : {1, 2, 8}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, size_t(threads));
        LiveEngine engine(scene, baked.atlas, baked.points, baked.phatexture, smallBake());
        SilentProgress progress;
        size_t tiles = 0;
        for (int i = 0; i < 6; ++i) {
            engine.setPose(boxMoved(scene, {0.05f * float(i), 0, 0}, 15.0f * float(i)));
            engine.advance(500'000, progress);
            tiles += engine.takeUpdate().phatexels.size();
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
TEST(Live, UpdatesAreComplete) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    LiveEngine engine(scene, baked.atlas, baked.points, baked.phatexture, smallBake());
    Phatexture drawn = baked.phatexture;
    const uint32_t width = baked.atlas.sizeTexels.x;
    const auto texelOf = [&](uint32_t tile, uint32_t i) {
        const uint32_t wide = baked.atlas.sizeTiles().x;
        return size_t(tile / wide * kTileSize + i / kTileSize) * width + tile % wide * kTileSize +
               i % kTileSize;
    };
    SilentProgress progress;
    for (int step = 0; step < 8; ++step) {
        engine.setPose(boxMoved(scene, {0.05f * float(step % 5), 0, 0}, 15.0f * float(step)));
        engine.advance(400'000, progress);
        const LiveUpdate update = engine.takeUpdate();
        for (const LiveUpdate::Guides& guides : update.guides) {
            drawn.indirectGuides[guides.block] = guides.indirect;
            drawn.areaGuides[guides.block] = guides.area;
        }
        for (const LiveUpdate::Phatexels& tile : update.phatexels)
            for (uint32_t i = 0; i < kTileTexels; ++i) {
                drawn.indirect[0].texels[texelOf(tile.tile, i)] = tile.texels[i];
                drawn.area[0].texels[texelOf(tile.tile, i)] = tile.texels[kTileTexels + i];
            }
        for (const LiveUpdate::Irradiance& tile : update.irradiance)
            for (uint32_t i = 0; i < kTileTexels; ++i) {
                drawn.indirectIrradiance[texelOf(tile.tile, i)] = tile.indirect[i];
                drawn.areaIrradiance[texelOf(tile.tile, i)] = tile.area[i];
            }
        for (const LiveUpdate::Place& place : update.places) {
            drawn.probes[place.tile] = place.probe;
            drawn.tilePlaces[place.tile] = place.packed;
        }
        // Invalid texels and those without a chart may keep what they had.
        size_t different = 0;
        for (size_t i = 0; i < drawn.indirect[0].texels.size(); ++i)
            if (baked.atlas.chartAt({i % width, i / width}) != kNoChart)
                different += drawn.indirectIrradiance[i] != engine.phatexture().indirectIrradiance[i];
        EXPECT_EQ(different, 0u);
        drawn.indirectIrradiance = engine.phatexture().indirectIrradiance;
        drawn.areaIrradiance = engine.phatexture().areaIrradiance;
        expectEqual(drawn, engine.phatexture());
        expectEqualBytes(drawn.tilePlaces, engine.phatexture().tilePlaces, "places");
    }
    EXPECT_TRUE(engine.takeUpdate().empty());
}

// With a new scene at every step nothing ever settles, but nothing is forgotten either.
TEST(Live, NoPieceGetsOldWhileEverythingMoves) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    LiveEngine engine(scene, baked.atlas, baked.points, baked.phatexture, smallBake());
    SilentProgress progress;
    std::vector<int> seen(baked.atlas.blockCount, 0);
    int oldest = 0;
    constexpr int kSteps = 60;
    for (int step = 1; step <= kSteps; ++step) {
        engine.setPose(
            boxMoved(scene, {0.2f + 0.2f * std::sin(0.3f * float(step)), 0, 0}, 5.0f * float(step)));
        engine.advance(600'000, progress);
        for (const LiveUpdate::Guides& guides : engine.takeUpdate().guides) {
            oldest = std::max(oldest, step - seen[guides.block]);
            seen[guides.block] = step;
        }
    }
    for (const int last : seen) oldest = std::max(oldest, kSteps - last);
    EXPECT_LT(oldest, 40);
    EXPECT_GT(engine.stats().indirectMaps.items, 3u);
    EXPECT_GT(engine.stats().areaMaps.items, 3u);
}

// Moves, removals to the far end, lamps switched, paint: whatever was begun and not finished, nothing of it
// is left.
TEST(Live, RandomChangesLeaveNothingBehind) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    LiveEngine engine(scene, baked.atlas, baked.points, baked.phatexture, smallBake());
    SilentProgress progress;
    Rng rng(7);
    constexpr int kChanges = 40;
    for (int i = 0; i < kChanges; ++i) {
        LivePose pose =
            boxMoved(scene, {0.5f * rng.uniform() - 0.2f, 0.1f * rng.uniform(), 0.5f * rng.uniform() - 0.2f},
                     360.0f * rng.uniform());
        if (rng.uniform() < 0.1f) pose.worldFromRest[kBoxNode] = glm::translate(glm::mat4(1), glm::vec3(50));
        if (rng.uniform() < 0.3f)
            pose.worldFromRest.push_back(
                glm::translate(glm::mat4(1), {0.2f * rng.uniform(), -0.3f * rng.uniform(), 0}));
        if (rng.uniform() < 0.3f) pose.lights.clear();
        if (rng.uniform() < 0.3f) pose.materials.back().emission = glm::vec3(8 * rng.uniform());
        if (rng.uniform() < 0.3f)
            pose.materials.front().baseColor = {rng.uniform(), rng.uniform(), rng.uniform(), 1};
        engine.setPose(pose);
        engine.advance(uint64_t(300'000 * rng.uniform()), progress);
        if (rng.uniform() < 0.5f) engine.takeUpdate();
    }
    engine.setPose(poseOf(scene));
    settle(engine);
    expectEqual(engine.phatexture(), baked.phatexture);
}

TEST(Live, SinglePhotonsCannotBeRenewed) {
    const Scene scene = roomWithBox();
    const Bake baked = bakeQuietly(scene);
    BakeSettings settings = smallBake();
    settings.directions = Directions::photons;
    EXPECT_THROW(LiveEngine(scene, baked.atlas, baked.points, baked.phatexture, settings),
                 std::invalid_argument);
}

}  // namespace
}  // namespace phat
