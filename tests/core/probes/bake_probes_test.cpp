// Light probes of baked rooms, against formulas and against path-traced irradiance.

#include "core/probes/bake_probes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>
#include <mutex>

#include "core/bake/bake.h"
#include "core/base/sobol.h"
#include "core/scene/enclosure.h"
#include "core/transport/path.h"
#include "io/gltf/gltf_loader.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

/// A scene, its bake, and probes of it.
struct ProbedRoom {
    Scene scene;
    RayScene rays;
    Bake bake;
    LightProbes probes;

    ProbedRoom(Scene given, uint64_t texels, int count) : scene(std::move(given)), rays(scene) {
        BakeSettings settings;
        settings.atlas.texelBudget = texels;
        settings.photons.count = 50'000;
        SilentProgress progress;
        bake = phat::bake(rays, settings, progress);
        probes = make(count, nullptr);
    }
    LightProbes make(int count, BakeJournal* journal) const {
        SilentProgress progress;
        std::atomic<uint64_t> rayCount = 0;
        return bakeLightProbes({rays, bake.atlas, bake.points, bake.phatexture}, {count, 1},
                               {progress, journal, rayCount});
    }
    glm::vec3 at(glm::vec3 position, glm::vec3 normal) const {
        const ProbeIrradiance e = probeIrradianceAt(probes, position, normal);
        return e.indirect + e.area;
    }
};

bool equal(const LightProbes& a, const LightProbes& b) {
    return a.lowWorld == b.lowWorld && a.cellMeters == b.cellMeters && a.gridSize == b.gridSize &&
           a.cells == b.cells && a.places == b.places && a.indirect == b.indirect && a.area == b.area &&
           a.distances == b.distances;
}

// Albedo .5 and emission 1 all round: the reflected radiance is 1/2 + 1/4 + ... = 1, and E = pi of either.
TEST(BakeProbes, FurnaceIsEven) {
    Scene scene;
    addRoom(scene, emitter(glm::vec3(1), 0.5f), {1, 1.5f, 2});
    const ProbedRoom room(std::move(scene), 30'000, 100);
    ASSERT_TRUE(isConsistent(room.probes));
    ASSERT_GT(room.probes.count(), 50u);
    Rng random(1);
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 p = glm::vec3(random.uniform2(), random.uniform()) * glm::vec3(1, 1.5f, 2);
        const ProbeIrradiance e = probeIrradianceAt(room.probes, p, spherePoint(i, 200));
        // Half a step of each byte: .5 / 127 of at most 2 (x + y + z), 1.25, .94 and 1.88 times the terms.
        EXPECT_NEAR(e.indirect.x / kPi, 1, 0.03f) << "point " << i;
        EXPECT_NEAR(e.area.x / kPi, 1, 0.03f) << "point " << i;
    }
}

// A sky that is 1 + g.w over a small thing: E = pi + 2 pi / 3 g.n where nothing is in the way.
TEST(BakeProbes, LinearSkyHasItsClosedForm) {
    Scene scene;
    for (const float side : {-1.0f, 1.0f})
        addOutwardBox(scene, lambert(0), {side, -1, side}, {0.02f, 2, 0.02f});
    Image sky(128, 64);
    const glm::vec3 g(0.3f, 0.5f, -0.4f);
    for (int y = 0; y < sky.height; ++y)
        for (int x = 0; x < sky.width; ++x) {
            const float azimuth = (float(x) + 0.5f) / float(sky.width) * 2 * kPi - kPi;
            const float polar = (float(y) + 0.5f) / float(sky.height) * kPi;
            const glm::vec3 w(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                              std::sin(polar) * std::sin(azimuth));
            sky.pixels[size_t(y) * size_t(sky.width) + size_t(x)] = glm::vec3(1 + glm::dot(g, w));
        }
    scene.environment = Environment{sky};
    const ProbedRoom room(std::move(scene), 4000, 64);
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 n = spherePoint(i, 100);
        EXPECT_NEAR(room.at({0.1f, -0.2f, 0.3f}, n).x, kPi + 2 * kPi / 3 * glm::dot(g, n), 0.03f * kPi);
    }
}

// Lit by a panel at low x; in two parts that share no surface, or in one.
Scene twoHalves(bool wall) {
    Scene scene;
    addRoom(scene, lambert(0.6f), {wall ? 0.93f : 2.0f, 1, 1});
    const size_t first = scene.positions.size();
    if (wall) addRoom(scene, lambert(0.6f), {1.05f, 1, 1});
    for (size_t i = first; i < scene.positions.size(); ++i) scene.positions[i].x += 0.95f;
    addQuad(scene, emitter(glm::vec3(4), 0.5f), {0.3f, 0.98f, 0.3f}, {0.4f, 0, 0}, {0, 0, 0.4f});
    return scene;
}

float meanOver(const ProbedRoom& room, glm::vec3 low, glm::vec3 high, float* largest = nullptr) {
    Rng random(2);
    constexpr int kPoints = 4000;
    float sum = 0;
    for (int i = 0; i < kPoints; ++i) {
        const glm::vec3 p = glm::mix(low, high, glm::vec3(random.uniform2(), random.uniform()));
        const float e = luminance(room.at(p, spherePoint(i, kPoints)));
        if (largest) *largest = std::max(*largest, e);
        sum += e / kPoints;
    }
    return sum;
}

TEST(BakeProbes, NoLightLeaksThroughAWall) {
    const ProbedRoom open(twoHalves(false), 30'000, 300), closed(twoHalves(true), 30'000, 300);
    const glm::vec3 low(0.96f, 0.01f, 0.01f), high(1.99f, 0.99f, 0.99f);
    const float lit = meanOver(closed, {0.01f, 0.01f, 0.01f}, {0.92f, 0.99f, 0.99f});
    EXPECT_GT(meanOver(open, low, high), 0.1f * lit);
    float largest = 0;
    meanOver(closed, low, high, &largest);
    EXPECT_LT(largest, 0.01f * lit);
}

TEST(BakeProbes, AreTheSameOnAnyNumberOfThreads) {
    const ProbedRoom room(twoHalves(true), 10'000, 120);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_TRUE(equal(room.make(120, nullptr), room.probes));
    EXPECT_FALSE(equal(room.make(90, nullptr), room.probes));
}

struct PartsInMemory : BakeJournal {
    std::map<uint64_t, std::vector<uint8_t>> parts;
    std::mutex mutex;
    int loads = 0;

    std::vector<uint8_t> load(uint64_t key) override {
        const std::lock_guard lock(mutex);
        const auto found = parts.find(key);
        loads += found != parts.end();
        return found == parts.end() ? std::vector<uint8_t>{} : found->second;
    }
    void store(uint64_t key, const std::vector<uint8_t>& bytes) override {
        const std::lock_guard lock(mutex);
        parts[key] = bytes;
    }
};

TEST(BakeProbes, AreTakenUpFromAJournal) {
    const ProbedRoom room(twoHalves(true), 10'000, 120);
    PartsInMemory journal;
    EXPECT_TRUE(equal(room.make(120, &journal), room.probes));
    EXPECT_EQ(journal.loads, 0);
    ASSERT_GT(journal.parts.size(), 3u);
    journal.parts.erase(journal.parts.begin());
    const int kept = int(journal.parts.size());
    EXPECT_TRUE(equal(room.make(120, &journal), room.probes));
    EXPECT_EQ(journal.loads, kept);
}

/// Irradiance without direct light of punctual lights, by paths.
glm::vec3 tracedIrradiance(const LitScene& scene, glm::vec3 position, glm::vec3 normal, uint64_t index) {
    uint64_t rays = 0;
    glm::vec3 sum = areaIrradiance(scene, position, normal, {64, 8}, Rng(hashOf(9, index)), rays).value;
    const Frame frame = frameFromNormal(normal);
    constexpr uint32_t kRays = 256;
    for (uint32_t k = 0; k < kRays; ++k) {
        const glm::vec4 s = shuffledSobol4(k, hashOf(3, index));
        const float radius = std::sqrt(s.x), angle = 2 * kPi * s.y;
        const glm::vec3 local(radius * std::cos(angle), radius * std::sin(angle),
                              std::sqrt(std::max(0.0f, 1 - s.x)));
        const IncidentRadiance incident = traceIncident(
            scene, {position, glm::normalize(frame.toWorld(local))}, {4, 12}, Rng(hashOf(8, index, k)));
        sum += incident.reflected * (kPi / float(kRays));
    }
    return sum;
}

// Whether a thing of some centimetres could be here: not in a surface, nor inside of a solid.
bool isFree(const RayScene& rays, glm::vec3 position) {
    for (int i = 0; i < 64; ++i)
        if (const Hit hit = rays.closestHit(position, spherePoint(i, 64)))
            if (hit.distance < 0.05f || (hit.backFace && !rays.scene().materialOf(hit.triangle).doubleSided))
                return false;
    return true;
}

class ProbedScenes : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, ProbedScenes, ::testing::Values("gallery", "tabletop", "cornell-glossy"),
                         [](const auto& scene) {
                             std::string name = scene.param;
                             std::erase(name, '-');
                             return name;
                         });

// The mean absolute error over the mean, anywhere in the room and for any normal.
TEST_P(ProbedScenes, AgreeWithPaths) {
    const std::string path = std::string(PHAT_SOURCE_DIR "/scenes/") + GetParam() + ".glb";
    const ProbedRoom room(loadGltf(path).scene, 150'000, ProbeSettings().count);
    const LightSampler lights(room.scene);
    const Bounds box = boundsWithoutGround(room.scene);
    Rng random(5);
    double error = 0, mean = 0;
    for (int points = 0; points < 100;) {
        const glm::vec3 u(random.uniform2(), random.uniform());
        const glm::vec3 position = glm::mix(box.low, box.high, u);
        const glm::vec3 normal = spherePoint(int(random.uniform() * 10'000), 10'000);
        if (!isFree(room.rays, position)) continue;
        const glm::vec3 e = tracedIrradiance({room.rays, lights}, position, normal, uint64_t(points++));
        error += double(luminance(glm::abs(room.at(position, normal) - e)));
        mean += double(luminance(e));
    }
    std::printf("%s: MAE/mean %.3f, %zu probes, %.0f kB\n", GetParam(), error / mean, room.probes.count(),
                double(probeBytes(room.probes)) * 1e-3);
    EXPECT_LT(error, 0.1 * mean);
    EXPECT_LT(probeBytes(room.probes), 300'000u);
}

}  // namespace
}  // namespace phat
