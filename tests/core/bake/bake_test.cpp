// The whole pipeline on rooms of a few thousand texels.

#include "core/bake/bake.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <map>
#include <mutex>
#include <set>

#include "core/render/lobe_gather.h"
#include "support/scene_builder.h"
#include "support/traced_irradiance.h"

namespace phat {
namespace {

using namespace test;

constexpr Directions kAllDirections[] = {Directions::guided, Directions::photons, Directions::nearestPhoton,
                                         Directions::uniform, Directions::cosine};
constexpr RadianceSource kAllSources[] = {RadianceSource::path, RadianceSource::photons,
                                          RadianceSource::splat};

BakeSettings smallBake(uint64_t texels, uint64_t photons) {
    BakeSettings settings;
    settings.atlas.texelBudget = texels;
    settings.photons.count = photons;
    return settings;
}

Bake bakeQuietly(const Scene& scene, const BakeSettings& settings, BakeJournal* journal = nullptr) {
    SilentProgress progress;
    return bake(scene, settings, progress, journal);
}

// Albedo .5 and emission 1 all round: the reflected radiance is 1/2 + 1/4 + ... = 1.
Scene furnace() {
    Scene scene;
    addRoom(scene, emitter(glm::vec3(1), 0.5f), {1, 1.5f, 2});
    return scene;
}

// A lamp's panel, a point light, one red wall.
Scene litRoom() {
    Scene scene;
    addRoom(scene, lambert(0.6f), {1, 1, 1});
    scene.materials[0].baseColor = {0.8f, 0.2f, 0.2f, 1};
    addQuad(scene, emitter(glm::vec3(4), 0.5f), {0.3f, 0.98f, 0.3f}, {0.4f, 0, 0}, {0, 0, 0.4f});
    scene.lights = {pointLight(glm::vec3(0.5f), {0.3f, 0.5f, 0.6f})};
    return scene;
}

struct Sums {
    double mean = 0, low = 1e30, high = -1e30;
    size_t count = 0;
};

template <typename Value>
Sums overTexels(const TexelPoints& points, const Value& value, bool guttersToo = false) {
    Sums sums;
    for (size_t i = 0; i < points.state.size(); ++i) {
        if (points.state[i] != TexelState::surface && !(guttersToo && points.state[i] == TexelState::gutter))
            continue;
        const double v = value(i);
        sums.mean += v;
        sums.low = std::min(sums.low, v);
        sums.high = std::max(sums.high, v);
        ++sums.count;
    }
    sums.mean /= double(std::max<size_t>(sums.count, 1));
    return sums;
}

TEST(Bake, FurnaceIsWhite) {
    BakeSettings settings = smallBake(30'000, 30'000);
    settings.pathsPerPhatexel = 32;  // so that what is left is the filters'
    const Bake result = bakeQuietly(furnace(), settings);
    const Phatexture& p = result.phatexture;
    ASSERT_EQ(p.indirect.size(), 1u);
    ASSERT_EQ(p.area.size(), 1u);

    double sum = 0;
    uint64_t valid = 0;
    for (size_t i = 0; i < p.indirect[0].texels.size(); ++i) {
        const Phatexel indirect = unpackPhatexel(p.indirect[0].texels[i], 1);
        const Phatexel area = unpackPhatexel(p.area[0].texels[i], 1);
        // A ray from a gutter extends past the wall and may miss the room.
        if (result.points.state[i] != TexelState::surface || !indirect.valid) continue;
        ASSERT_EQ(area.radiance, glm::vec3(1));
        sum += double(indirect.radiance.x);
        ++valid;
    }
    EXPECT_GT(valid, 10'000u);
    EXPECT_LE(valid, result.stats.validPhatexels);
    // 2^-9 by rounding at most; 32 paths of standard deviation about .3 over 10,000 texels: .0005.
    EXPECT_NEAR(sum / double(valid), 1, 0.005);

    const auto area =
        overTexels(result.points, [&](size_t i) { return unpackRgb9e5(p.areaIrradiance[i]).y / kPi; });
    EXPECT_NEAR(area.mean, 1, 0.005);
    const auto deviation = overTexels(
        result.points, [&](size_t i) { return square(unpackRgb9e5(p.areaIrradiance[i]).y / kPi - 1); });
    EXPECT_LT(std::sqrt(deviation.mean), 0.02);
}

// Of light that is reflected by .95 each time, a dozen reflections are not half.
TEST(Bake, WhiteRoomsGetTheLightOfAllReflections) {
    Scene scene;
    addRoom(scene, emitter(glm::vec3(1), 0.95f), {1, 1.5f, 2});
    const Bake result = bakeQuietly(scene, smallBake(2000, 10'000));
    const auto reflected = overTexels(result.points, [&](size_t i) {
        return unpackRgb9e5(result.phatexture.indirectIrradiance[i]).y / kPi;
    });
    constexpr double kAll = 0.95 / (1 - 0.95);
    EXPECT_NEAR(reflected.mean, kAll, 0.005 * kAll);
}

// Every ray brings the same light: edges and corners are no exception, and a few texels a wall are enough.
TEST(Bake, FurnaceIsEvenlyLitInItsCorners) {
    for (const uint64_t texels : {1500, 30'000}) {
        BakeSettings settings = smallBake(texels, 10'000);
        settings.pathsPerPhatexel = 1;
        const Bake result = bakeQuietly(furnace(), settings);
        const auto irradiance = overTexels(result.points, [&](size_t i) {
            return unpackRgb9e5(result.phatexture.indirectIrradiance[i]).y / kPi;
        });
        EXPECT_NEAR(irradiance.mean, 1, 0.005) << texels;
        EXPECT_GT(irradiance.low, 0.99) << texels;
        EXPECT_LT(irradiance.high, 1.01) << texels;
    }
}

// Against paths, in a room with a lamp, a point light, a metal wall and a box on the floor: at texels
// anywhere, those beside walls included.
TEST(Bake, IndirectIrradianceIsThatOfPaths) {
    Scene scene;
    addRoom(scene, lambert(0.6f), {1, 1, 1});
    scene.materials[0].baseColor = {0.8f, 0.2f, 0.2f, 1};
    // Off the ceiling by more than a few texels: narrower gaps are below the resolution.
    addQuad(scene, emitter(glm::vec3(4), 0.5f), {0.3f, 0.85f, 0.3f}, {0.4f, 0, 0}, {0, 0, 0.4f});
    scene.lights = {pointLight(glm::vec3(0.5f), {0.3f, 0.5f, 0.6f})};
    scene.materials[1].metallic = 1;
    scene.materials[1].roughness = 0.4f;
    const glm::vec3 low(0.55f, 0, 0.5f), x(0.25f, 0, 0), y(0, 0.3f, 0), z(0, 0, 0.25f);
    const Material gray = lambert(0.7f);
    addQuad(scene, gray, low + y, z, x);  // a box on the floor
    addQuad(scene, gray, low, y, x);
    addQuad(scene, gray, low + z, x, y);
    addQuad(scene, gray, low, z, y);
    addQuad(scene, gray, low + x, y, z);
    BakeSettings settings = smallBake(60'000, 20'000);
    settings.pathsPerPhatexel = 1;
    const Bake result = bakeQuietly(scene, settings);
    const RayScene rays(scene);
    const LightSampler lights(scene);

    std::vector<size_t> texels;
    for (size_t i = 0; i < result.points.state.size(); ++i)
        if (result.points.state[i] == TexelState::surface) texels.push_back(i);
    ASSERT_GT(texels.size(), 10'000u);
    double error = 0, bias = 0, truth = 0;
    constexpr int kPoints = 200;
    for (int point = 0; point < kPoints; ++point) {
        const size_t i = texels[texels.size() * size_t(point) / kPoints];
        const auto [mean, deviation] =
            tracedIrradiance(rays, lights, result.points.position[i], result.points.normal[i], 4000);
        const double found = luminance(unpackRgb9e5(result.phatexture.indirectIrradiance[i]));
        EXPECT_NEAR(found, mean, 0.05 * mean + 4 * deviation) << point;
        error += std::abs(found - mean);
        bias += found - mean;
        truth += mean;
    }
    EXPECT_LT(error / truth, 0.02);
    EXPECT_NEAR(bias / truth, 0, 0.01);
}

bool equalLayers(const std::vector<PhatexelLayer>& a, const std::vector<PhatexelLayer>& b) {
    if (a.size() != b.size()) return false;
    for (size_t i = 0; i < a.size(); ++i) {
        if (a[i].texels.size() != b[i].texels.size() || a[i].pdf != b[i].pdf) return false;
        if (std::memcmp(a[i].texels.data(), b[i].texels.data(), a[i].texels.size() * sizeof(PackedPhatexel)))
            return false;
    }
    return true;
}

bool equalBakes(const Bake& a, const Bake& b) {
    const auto equalGuides = [](const std::vector<Guide>& x, const std::vector<Guide>& y) {
        return x.size() == y.size() && !std::memcmp(x.data(), y.data(), x.size() * sizeof(Guide));
    };
    return equalLayers(a.phatexture.indirect, b.phatexture.indirect) &&
           equalLayers(a.phatexture.area, b.phatexture.area) &&
           equalGuides(a.phatexture.indirectGuides, b.phatexture.indirectGuides) &&
           equalGuides(a.phatexture.areaGuides, b.phatexture.areaGuides) &&
           a.phatexture.areaIrradiance == b.phatexture.areaIrradiance &&
           a.phatexture.indirectIrradiance == b.phatexture.indirectIrradiance &&
           a.points.position == b.points.position;
}

TEST(Bake, SameBytesForAnyNumberOfThreads) {
    const Scene scene = litRoom();
    for (const Directions directions : kAllDirections) {
        for (const RadianceSource source : kAllSources) {
            if (source == RadianceSource::splat && !choosesPhotons(directions)) continue;
            BakeSettings settings = smallBake(3000, 3000);
            settings.directions = directions;
            settings.radiance = source;
            settings.layers = 2;
            settings.pathsPerPhatexel = 1;
            settings.maxBounces = 3;
            std::vector<Bake> bakes;
            for (int threads : {1, 2, 8}) {
                const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                                size_t(threads));
                bakes.push_back(bakeQuietly(scene, settings));
            }
            EXPECT_TRUE(equalBakes(bakes[0], bakes[1]) && equalBakes(bakes[0], bakes[2]))
                << int(directions) << ' ' << int(source);
            EXPECT_FALSE(equalLayers({bakes[0].phatexture.indirect[0]}, {bakes[0].phatexture.indirect[1]}));
            settings.seed = 2;
            EXPECT_FALSE(equalBakes(bakes[0], bakeQuietly(scene, settings)));
        }
    }
}

TEST(Bake, SplatsNeedPhotons) {
    BakeSettings settings = smallBake(3000, 1000);
    settings.radiance = RadianceSource::splat;
    for (const Directions directions : {Directions::guided, Directions::uniform, Directions::cosine}) {
        settings.directions = directions;
        EXPECT_THROW(bakeQuietly(litRoom(), settings), std::invalid_argument);
    }
}

// What the PHATexels say the texels receive on average: pi times the mean of L weighed by a = cos / p.
double irradianceOfPhatexels(const Scene& scene, const BakeSettings& settings) {
    const Bake result = bakeQuietly(scene, settings);
    const Phatexture& p = result.phatexture;
    const uint32_t width = result.atlas.sizeTexels.x;
    double light = 0, weights = 0;
    for (uint32_t i = 0; i < result.points.state.size(); ++i) {
        if (result.points.state[i] != TexelState::surface) continue;
        const Phatexel phatexel =
            phatexelAt(p.indirect[0], p.indirectGuides, result.atlas, {i % width, i / width});
        if (!phatexel.valid) continue;
        const double a = phatexel.directionBlock.z / phatexel.pdf;
        light += a * luminance(phatexel.radiance);
        weights += a;
    }
    return double(kPi) * light / weights;
}

// All combinations estimate the same light. What is unbiased agrees within its noise; density estimation
// darkens corners and edges (no photons beyond), by less than 5 % here. Photon directions leave out where
// none came from, which is where it is darker: a mean of radiance is 5 to 6 % too bright.
TEST(Bake, MethodsAgreeOnDiffuseLight) {
    const Scene scene = litRoom();
    BakeSettings settings = smallBake(6000, 100'000);
    settings.density.maxRadius = 0.08f;
    const Bake result = bakeQuietly(scene, settings);
    const double truth = overTexels(result.points, [&](size_t i) {
                             return luminance(unpackRgb9e5(result.phatexture.indirectIrradiance[i]));
                         }).mean;
    for (const Directions directions : kAllDirections) {
        for (const RadianceSource source : kAllSources) {
            if (source == RadianceSource::splat && !choosesPhotons(directions)) continue;
            settings.directions = directions;
            settings.radiance = source;
            const double mean = irradianceOfPhatexels(scene, settings);
            const bool splat = source == RadianceSource::splat;
            const double tolerance = splat                            ? 0.03
                                     : choosesPhotons(directions)     ? 0.1
                                     : source == RadianceSource::path ? 0.01
                                                                      : 0.03;
            EXPECT_NEAR(mean, truth, tolerance * truth) << int(directions) << ' ' << int(source);
        }
    }
}

// The mean over blocks and lobes of what a lobe sees by the ratio of sums, as the renderers form it.
double incidentUnderLobes(const Bake& baked, float alpha) {
    const Phatexture& p = baked.phatexture;
    const uint32_t width = baked.atlas.sizeTexels.x;
    constexpr int kEyes = 12;
    std::vector<std::array<double, 2 * kEyes>> sums(baked.atlas.blockCount);
    for (uint32_t i = 0; i < baked.points.state.size(); ++i) {
        if (baked.points.state[i] != TexelState::surface) continue;
        const glm::uvec2 xy(i % width, i / width);
        const Phatexel phatexel = phatexelAt(p.indirect[0], p.indirectGuides, baked.atlas, xy);
        if (!phatexel.valid) continue;
        for (int eye = 0; eye < kEyes; ++eye) {
            const float turn = 2 * kPi * float(eye) / kEyes;
            const GatherLobe lobe{.towardEye = {0.6f * std::cos(turn), 0.6f * std::sin(turn), 0.8f},
                                  .alpha = alpha};
            const double a = lobe.value(phatexel.directionBlock) / phatexel.pdf;
            sums[baked.atlas.blockAt(xy)][size_t(2 * eye)] += a * luminance(phatexel.radiance);
            sums[baked.atlas.blockAt(xy)][size_t(2 * eye + 1)] += a;
        }
    }
    double mean = 0, count = 0;
    for (const auto& block : sums)
        for (int eye = 0; eye < kEyes; ++eye) {
            if (block[size_t(2 * eye + 1)] <= 0) continue;
            mean += block[size_t(2 * eye)] / block[size_t(2 * eye + 1)];
            count += 1;
        }
    return mean / count;
}

// Splats and rays to the same density estimate hold the same light, in lobes as well, block for block: the
// rest is what the estimate darkens near edges, once where light arrives and once where it came from.
TEST(Bake, SplatsHoldTheLightOfPhotonRadiance) {
    const Scene scene = litRoom();
    BakeSettings settings = smallBake(12'000, 100'000);
    settings.density.maxRadius = 0.08f;
    settings.radiance = RadianceSource::photons;
    const Bake truth = bakeQuietly(scene, settings);
    settings.radiance = RadianceSource::splat;
    for (const Directions directions : {Directions::photons, Directions::nearestPhoton}) {
        settings.directions = directions;
        const Bake splats = bakeQuietly(scene, settings);
        for (const float alpha : {1.0f, 0.4f, 0.2f}) {
            const double expected = incidentUnderLobes(truth, alpha);
            EXPECT_NEAR(incidentUnderLobes(splats, alpha), expected, 0.06 * expected)
                << int(directions) << ' ' << alpha;
        }
    }
}

/// Keeps everything; fails like a full disk at the given part.
struct MemoryJournal : BakeJournal {
    std::vector<uint8_t> load(uint64_t key) override {
        const std::lock_guard lock(mutex);
        const auto found = parts.find(key);
        if (found == parts.end()) return {};
        ++loaded;
        return found->second;
    }
    void store(uint64_t key, const std::vector<uint8_t>& bytes) override {
        const std::lock_guard lock(mutex);
        if (parts.size() >= failAt) throw std::runtime_error("the disk is full");
        EXPECT_TRUE(parts.emplace(key, bytes).second) << "a part was stored twice, or two share a key";
    }
    std::mutex mutex;
    std::map<uint64_t, std::vector<uint8_t>> parts;
    size_t failAt = ~size_t(0);
    size_t loaded = 0;
};

TEST(Bake, ResumesAfterFailureToTheSameBytes) {
    const Scene scene = litRoom();
    BakeSettings settings = smallBake(12'000, 5000);
    settings.layers = 2;
    const Bake whole = bakeQuietly(scene, settings);

    MemoryJournal uninterrupted;
    EXPECT_TRUE(equalBakes(whole, bakeQuietly(scene, settings, &uninterrupted)));
    const size_t partCount = uninterrupted.parts.size();
    ASSERT_GT(partCount, 8u);

    MemoryJournal journal;
    for (const size_t failAt : {size_t(0), partCount / 3, partCount - 1}) {
        journal.failAt = failAt;
        EXPECT_THROW(bakeQuietly(scene, settings, &journal), std::runtime_error);
        EXPECT_EQ(journal.parts.size(), failAt);
    }
    journal.failAt = ~size_t(0);
    journal.loaded = 0;
    const Bake resumed = bakeQuietly(scene, settings, &journal);
    EXPECT_TRUE(equalBakes(whole, resumed));
    EXPECT_EQ(journal.loaded, partCount - 1);
    EXPECT_LT(resumed.stats.rays, whole.stats.rays / 4);

    // Damaged lengths count as missing.
    for (auto& [key, bytes] : journal.parts) bytes.resize(bytes.size() / 2);
    std::swap(journal.parts, uninterrupted.parts);
    EXPECT_TRUE(equalBakes(whole, bakeQuietly(scene, settings, &journal)));
}

/// Asks to stop once `stage` has begun.
struct StopAt : SilentProgress {
    explicit StopAt(std::string s) : stage(std::move(s)) {}
    void begin(const char* name, uint64_t) override {
        ++depth;
        stages.insert(name);
        if (name == stage) stop = true;
    }
    void end() override { --depth; }
    bool stopRequested() const override { return stop; }
    std::string stage;
    std::set<std::string> stages;  // that began
    std::atomic<bool> stop = false;
    std::atomic<int> depth = 0;
};

TEST(Bake, StopsInEveryStage) {
    const Scene scene = litRoom();
    const BakeSettings settings = smallBake(3000, 2000);
    StopAt never("");
    EXPECT_NO_THROW(bake(scene, settings, never));
    EXPECT_EQ(never.depth, 0) << "every stage that begins ends";
    EXPECT_GE(never.stages.size(), 8u);
    for (const std::string& stage : never.stages) {
        StopAt progress(stage);
        EXPECT_THROW(bake(scene, settings, progress), Interrupted) << stage;
    }
}

// Black walls reflect nothing: all light is direct, all PHATexels are dark, whatever their method.
TEST(Bake, DirectLightIsLeftOut) {
    Scene scene = litRoom();
    for (Material& material : scene.materials) material.baseColor = {0, 0, 0, 1};
    for (const RadianceSource source : kAllSources) {
        BakeSettings settings = smallBake(3000, 5000);
        settings.directions = Directions::photons;
        settings.radiance = source;
        const Bake result = bakeQuietly(scene, settings);
        for (const PackedPhatexel packed : result.phatexture.indirect[0].texels)
            ASSERT_EQ(unpackPhatexel(packed, 1).radiance, glm::vec3(0)) << int(source);
        for (const uint32_t irradiance : result.phatexture.indirectIrradiance)
            ASSERT_EQ(unpackRgb9e5(irradiance), glm::vec3(0)) << int(source);
    }
}

TEST(Bake, SidesThatLightReachesGetTexels) {
    Scene room = litRoom();
    Material sheet = lambert(0.5f);
    sheet.doubleSided = true;
    addQuad(room, sheet, {0.2f, 0.2f, 0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f});
    const uint32_t sheetSurface = uint32_t(room.surfaces.size() - 1);
    const Bake result = bakeQuietly(room, smallBake(6000, 20'000));
    int fronts = 0, backs = 0;
    for (const Chart& chart : result.atlas.charts) {
        if (chart.surface != sheetSurface) {
            EXPECT_FALSE(chart.back) << "walls are lit from inside only";
            continue;
        }
        ++(chart.back ? backs : fronts);
        ASSERT_NE(chart.otherSide, kNoChart);
        EXPECT_NE(result.atlas.charts[chart.otherSide].back, chart.back);
        EXPECT_EQ(result.atlas.charts[chart.otherSide].sizeTiles, chart.sizeTiles);
    }
    EXPECT_EQ(fronts, 1);
    EXPECT_EQ(backs, 1);
}

TEST(Bake, DarkAndPunctualScenesHaveNoAreaLight) {
    Scene scene;
    addRoom(scene, lambert(0.5f), {1, 1, 1});
    for (const uint32_t irradiance : bakeQuietly(scene, smallBake(3000, 1000)).phatexture.indirectIrradiance)
        ASSERT_EQ(irradiance, 0u);
    scene.lights = {pointLight(glm::vec3(1), {0.5f, 0.5f, 0.5f})};
    const Bake result = bakeQuietly(scene, smallBake(3000, 1000));
    EXPECT_TRUE(result.phatexture.area.empty());
    EXPECT_TRUE(result.phatexture.areaIrradiance.empty());
    EXPECT_EQ(result.stats.texels, result.atlas.texelCount());
    EXPECT_GT(result.stats.rays, result.stats.validPhatexels);
}

}  // namespace
}  // namespace phat
