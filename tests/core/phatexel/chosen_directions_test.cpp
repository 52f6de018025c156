// Where PHATexels look, under an incident field that is known in closed form and photons drawn from it.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>

#include "core/base/random.h"
#include "core/phatexel/directions.h"
#include "core/phatexel/photon_directions.h"
#include "core/render/lobe_gather.h"
#include "support/chi_squared.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using namespace test;

const glm::vec3 kLamp = glm::normalize(glm::vec3(0.6f, 0.5f, 0.2f));  // world; the floor's normal is +y

// Radiance from a direction of the world.
float field(glm::vec3 toward) {
    return 0.5f + 4 * std::pow(std::max(glm::dot(toward, kLamp), 0.0f), 16.0f);
}

glm::vec3 upward(glm::vec2 square) {
    const glm::vec3 local = squareToHemisphere(square);
    return {local.x, local.z, local.y};
}

// Midpoint rule over equal solid angles.
double irradianceOfField() {
    constexpr int kSteps = 1000;
    double sum = 0;
    for (int i = 0; i < kSteps * kSteps; ++i) {
        const glm::vec3 d = upward((glm::vec2(i % kSteps, i / kSteps) + 0.5f) / float(kSteps));
        sum += double(field(d) * d.y);
    }
    return sum * 2 * double(kPi) / (double(kSteps) * kSteps);
}

Photon photonOnFloor(glm::vec2 position, glm::vec3 toward, float flux) {
    Photon photon;
    photon.position = {position.x - 0.5f, 0, position.y - 0.5f};
    photon.fluxWatts = glm::vec3(flux);
    photon.towardOrigin = toward;
    photon.normal = {0, 1, 0};
    photon.triangle = 0;
    return photon;
}

// A floor of 1 m2 that receives the field: directions with density L cos / E, equal fluxes.
PhotonMap photonsOfField(int count) {
    PhotonMap map;
    Rng rng(21);
    const float flux = float(irradianceOfField()) / float(count);
    while (int(map.photons.size()) < count) {
        const glm::vec3 d = upward(rng.uniform2());
        if (rng.uniform() * 4.5f < field(d) * d.y)
            map.photons.push_back(photonOnFloor(rng.uniform2(), d, flux));
    }
    return map;
}

/// A floor with 1.6 cm texels and the photons on it.
struct World {
    explicit World(PhotonMap map) : photons(std::move(map)), index(photons.photons) {
        addFloor(scene, lambert(0.5f), 1);
        AtlasSettings settings;
        settings.texelSizeMeters = 1.0f / 64;
        SilentProgress progress;
        atlas = buildAtlas(scene, {}, settings, progress);
        points = buildTexelPoints(scene, atlas);
        frames = blockFrames(atlas, points);
    }
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    std::vector<Guide> guides(PhotonFilter keep = isIndirectPhoton) const {
        SilentProgress progress;
        return buildGuides({atlas, points, frames}, {photons, index}, keep, progress);
    }
    ChosenDirections choose(Directions strategy, const std::vector<Guide>& with, uint64_t seed, int layer = 0,
                            bool splatsRadiance = false) const {
        SilentProgress progress;
        const DirectionSettings settings{strategy, {100, 0.25f}, seed, layer, splatsRadiance};
        return choosesPhotons(strategy)
                   ? choosePhotonDirections({atlas, points, frames}, {photons, index}, isIndirectPhoton,
                                            settings, progress)
                   : chooseGuidedDirections({atlas, points, frames}, with, settings, progress);
    }
    glm::uvec2 texelAt(size_t texel) const {
        return {texel % atlas.sizeTexels.x, texel / atlas.sizeTexels.x};
    }
    glm::vec3 toWorld(size_t texel, glm::vec3 direction) const {
        return frames[atlas.blockAt(texelAt(texel))].toWorld(direction);
    }
    /// Leaves nothing but texels whose neighbourhood lies on the floor: at its rim a density estimate is too
    /// dark.
    void keepInner() {
        const std::vector<size_t> kept = inner();
        points.state.assign(atlas.texelCount(), TexelState::unused);
        for (const size_t texel : kept) points.state[texel] = TexelState::surface;
    }
    // Texels whose neighbourhood lies on the floor.
    std::vector<size_t> inner() const {
        std::vector<size_t> texels;
        for (size_t i = 0; i < atlas.texelCount(); ++i)
            if (points.state[i] == TexelState::surface && std::abs(points.position[i].x) < 0.35f &&
                std::abs(points.position[i].z) < 0.35f)
                texels.push_back(i);
        return texels;
    }

    Scene scene;
    PhotonMap photons;
    PhotonIndex index;
    Atlas atlas;
    TexelPoints points;
    std::vector<Frame> frames;
};

struct GuidedStrategy {
    Directions strategy;
    std::vector<Guide> guides;
};

std::vector<GuidedStrategy> guidedStrategies(const World& world) {
    return {{Directions::uniform, {uniformGuide()}},
            {Directions::cosine, {cosineGuide()}},
            {Directions::guided, world.guides()}};
}

// Four bins a cell of the guides, so that places within cells count too.
constexpr int kBins = 2 * kGuideSize;

size_t binOf(glm::vec3 direction) {
    const glm::ivec2 bin = glm::min(glm::ivec2(hemisphereToSquare(direction) * float(kBins)), kBins - 1);
    return size_t(bin.y) * kBins + size_t(bin.x);
}

TEST(ChosenDirections, FollowTheirGuides) {
    const World world(photonsOfField(50'000));
    const std::vector<size_t> texels = world.inner();
    ASSERT_GT(texels.size(), 1000u);
    for (const GuidedStrategy& s : guidedStrategies(world)) {
        std::vector<double> counts(kBins * kBins, 0.0), expected(counts.size(), 0.0);
        for (uint64_t seed = 0; seed < 30; ++seed) {
            const ChosenDirections chosen = world.choose(s.strategy, s.guides, seed);
            EXPECT_TRUE(chosen.splatRadiance.empty());
            for (const size_t texel : texels) {
                const glm::vec3 direction = chosen.directionBlock[texel];
                const Guide& guide =
                    s.guides[s.guides.size() == 1 ? 0 : world.atlas.blockAt(world.texelAt(texel))];
                ASSERT_FLOAT_EQ(chosen.pdf[texel], squareToGuidePdf(guide, direction));
                counts[binOf(direction)] += 1;
                for (int cell = 0; cell < kGuideCells; ++cell) {
                    const int x = 2 * (cell % kGuideSize), y = 2 * (cell / kGuideSize);
                    const double probability = double(guide.weight[cell]) / kGuideTotal / 4;
                    for (int i = 0; i < 4; ++i) expected[(y + i / 2) * kBins + x + i % 2] += probability;
                }
            }
        }
        const ChiSquared result = chiSquared(counts, expected);
        EXPECT_LT(result.value, result.limit) << int(s.strategy);
    }
}

TEST(ChosenDirections, EstimateIrradianceWithoutBias) {
    const World world(photonsOfField(50'000));
    const std::vector<size_t> texels = world.inner();
    const double truth = irradianceOfField();
    for (const GuidedStrategy& s : guidedStrategies(world)) {
        constexpr int kSeeds = 40;
        double sum = 0, squares = 0;
        for (int seed = 0; seed < kSeeds; ++seed) {
            const ChosenDirections chosen = world.choose(s.strategy, s.guides, uint64_t(seed), seed % 3);
            double mean = 0;
            for (const size_t texel : texels) {
                const glm::vec3 d = world.toWorld(texel, chosen.directionBlock[texel]);
                mean += double(field(d) * d.y / chosen.pdf[texel]) / double(texels.size());
            }
            sum += mean;
            squares += mean * mean;
        }
        const double mean = sum / kSeeds;
        const double standardError = std::sqrt(std::max(squares / kSeeds - mean * mean, 0.0) / (kSeeds - 1));
        EXPECT_NEAR(mean, truth, 4 * standardError + 1e-5 * truth) << int(s.strategy);
        EXPECT_LT(standardError, 5e-3 * truth);
    }
}

// Over many seeds one texel's directions fall into the cells as often as its density says.
TEST(ChosenDirections, PhotonsFollowTheirDensity) {
    World world(photonsOfField(20'000));
    const size_t texel = world.inner()[700];
    world.points.state.assign(world.atlas.texelCount(), TexelState::unused);
    world.points.state[texel] = TexelState::surface;
    constexpr int kSeeds = 1500;
    std::vector<double> counts(kGuideCells, 0.0), expected(kGuideCells, 0.0);
    for (uint64_t seed = 0; seed < kSeeds; ++seed) {
        const ChosenDirections chosen = world.choose(Directions::photons, {}, seed);
        const glm::ivec2 at(hemisphereToSquare(chosen.directionBlock[texel]) * float(kGuideSize));
        const size_t cell = size_t(at.y) * kGuideSize + size_t(at.x);
        counts[cell] += 1;
        expected[cell] = kSeeds * double(chosen.pdf[texel]) * 2 * double(kPi) / kGuideCells;
    }
    double total = 0;
    for (const double e : expected) total += e / kSeeds;
    EXPECT_NEAR(total, 1, 0.02) << "cells that were never drawn hold next to nothing";
    const ChiSquared result = chiSquared(counts, expected);
    EXPECT_GT(result.degreesOfFreedom, 20);
    EXPECT_LT(result.value, result.limit);
}

TEST(ChosenDirections, NearestPhotonTakesTheNearest) {
    const World world(photonsOfField(5'000));
    const ChosenDirections chosen = world.choose(Directions::nearestPhoton, {}, 3);
    for (const size_t texel : world.inner()) {
        std::vector<PhotonIndex::Neighbor> neighbors;
        world.index.nearest(world.points.position[texel], 100, 0.25f, neighbors);
        neighbors.pop_back();  // the 100th marks the rim
        const Frame& frame = world.frames[world.atlas.blockAt(world.texelAt(texel))];
        const auto cellOf = [&](uint32_t photon) {
            const glm::vec3 local = frame.toLocal(world.photons.photons[photon].towardOrigin);
            return glm::min(glm::ivec2(hemisphereToSquare(local) * float(kGuideSize)), kGuideSize - 1);
        };
        const glm::ivec2 cell = cellOf(neighbors[0].photon);
        const glm::ivec2 chosenCell(hemisphereToSquare(chosen.directionBlock[texel]) * float(kGuideSize));
        ASSERT_EQ(chosenCell, cell);
        int same = 0;
        for (const PhotonIndex::Neighbor& n : neighbors) same += cellOf(n.photon) == cell;
        const float probability = float(same) / float(neighbors.size());
        ASSERT_NEAR(chosen.pdf[texel], probability * kGuideCells / (2 * kPi), 1e-4f * chosen.pdf[texel]);
    }
}

// The splats are the filtered density estimate: they carry the irradiance as a mean of cos L / p and as the
// ratio of that to the mean of cos / p, which is what estimators form. The rest is the noise of 50,000
// photons.
TEST(ChosenDirections, SplatsCarryTheIrradiance) {
    World world(photonsOfField(50'000));
    world.keepInner();
    for (const Directions strategy : {Directions::photons, Directions::nearestPhoton}) {
        double light = 0, weight = 0, count = 0;
        for (uint64_t seed = 0; seed < 4; ++seed) {
            const ChosenDirections chosen = world.choose(strategy, {}, seed, 0, true);
            for (const size_t texel : world.inner()) {
                const float a = chosen.directionBlock[texel].z / chosen.pdf[texel];
                light += double(chosen.splatRadiance[texel].x * a);
                weight += double(a);
                count += 1;
            }
        }
        EXPECT_NEAR(light / count, irradianceOfField(), 0.02 * irradianceOfField()) << int(strategy);
        EXPECT_NEAR(weight / count, kPi, 0.02 * kPi) << int(strategy);
    }
}

// What a lobe sees by the ratio of sums over the texels of one block, as the renderers form it, is the
// field's mean under the lobe. Few texels and a heavy-tailed density would make the ratio too bright, and
// directions that leave out the cells without photons many times so: 13 to 17 times here.
TEST(ChosenDirections, SplatsHoldTheRadianceUnderLobes) {
    World world(photonsOfField(50'000));
    world.keepInner();
    std::map<uint32_t, std::vector<size_t>> blocks;
    for (const size_t texel : world.inner())
        blocks[world.atlas.blockAt(world.texelAt(texel))].push_back(texel);
    for (const Directions strategy : {Directions::photons, Directions::nearestPhoton}) {
        const ChosenDirections chosen = world.choose(strategy, {}, 1, 0, true);
        for (const float alpha : {1.0f, 0.4f, 0.2f}) {
            double ratios = 0, expected = 0, count = 0;
            for (const auto& [block, texels] : blocks) {
                if (texels.size() < 256) continue;
                const Frame& frame = world.frames[block];
                const GatherLobe lobe{.towardEye = {0.36f, 0.48f, 0.8f}, .alpha = alpha};
                double light = 0, weight = 0, fieldLight = 0, fieldWeight = 0;
                for (const size_t texel : texels) {
                    const glm::vec3 direction = chosen.directionBlock[texel];
                    const double a = lobe.value(direction) / chosen.pdf[texel];
                    light += a * chosen.splatRadiance[texel].x;
                    weight += a;
                }
                Rng rng(1);
                for (int i = 0; i < 100'000; ++i) {
                    const glm::vec3 direction = squareToHemisphere(rng.uniform2());
                    fieldLight += lobe.value(direction) * field(frame.toWorld(direction));
                    fieldWeight += lobe.value(direction);
                }
                ratios += light / weight;
                expected += fieldLight / fieldWeight;
                count += 1;
            }
            ASSERT_GT(count, 3);
            EXPECT_NEAR(ratios, expected, 0.05 * expected) << int(strategy) << ' ' << alpha;
        }
    }
}

TEST(Guides, PointWhereTheLightIs) {
    PhotonMap map;
    Rng rng(22);
    for (int i = 0; i < 5000; ++i) map.photons.push_back(photonOnFloor(rng.uniform2(), kLamp, 1));
    const World world(map);
    const std::vector<Guide> guides = world.guides();
    for (const size_t texel : world.inner()) {
        const uint32_t block = world.atlas.blockAt(world.texelAt(texel));
        const glm::vec3 lamp = world.frames[block].toLocal(kLamp);
        const float uniform = 1 / (2 * kPi);
        // .7 of the density in 3x3 of 256 cells.
        ASSERT_GT(squareToGuidePdf(guides[block], lamp), 0.6f * kGuideCells / 9 * uniform);
        const glm::vec3 elsewhere(-lamp.x, -lamp.y, lamp.z);
        ASSERT_NEAR(squareToGuidePdf(guides[block], elsewhere), 0.3f * uniform, 0.03f * uniform);
    }
}

// Photons arrive as L cos; the guide is to be as dense as L.
TEST(Guides, AreProportionalToRadiance) {
    PhotonMap map;
    Rng rng(23);
    const glm::vec3 steep = glm::normalize(glm::vec3(-0.4f, 1, 0)),
                    grazing = glm::normalize(glm::vec3(1, 0.3f, 0));
    for (int i = 0; i < 20'000; ++i) {
        map.photons.push_back(photonOnFloor(rng.uniform2(), steep, steep.y));
        map.photons.push_back(photonOnFloor(rng.uniform2(), grazing, grazing.y));
    }
    const World world(map);
    const std::vector<Guide> guides = world.guides();
    const uint32_t block = world.atlas.blockAt(world.texelAt(world.inner()[500]));
    const Frame& frame = world.frames[block];
    EXPECT_NEAR(squareToGuidePdf(guides[block], frame.toLocal(grazing)) /
                    squareToGuidePdf(guides[block], frame.toLocal(steep)),
                1, 0.05);
}

// Direct light is not in the indirect guides (section 5.2), punctual light in none; nor is what fell on
// surfaces that face elsewhere.
TEST(Guides, KeepToTheirKindOfLight) {
    const glm::vec3 ways[] = {glm::normalize(glm::vec3(1, 1, 0)), glm::normalize(glm::vec3(-1, 1, 0)),
                              glm::normalize(glm::vec3(0, 1, 1)), glm::normalize(glm::vec3(0, 1, -1))};
    PhotonMap map;
    Rng rng(24);
    for (int i = 0; i < 20'000; ++i) {
        Photon photon = photonOnFloor(rng.uniform2(), ways[i % 4], 1);
        photon.firstHit = i % 4 != 0;
        photon.punctual = i % 4 == 2;
        if (i % 4 == 3) photon.normal = {1, 0, 0};
        map.photons.push_back(photon);
    }
    const World world(map);
    const uint32_t block = world.atlas.blockAt(world.texelAt(world.inner()[500]));
    for (const bool indirect : {true, false}) {
        const std::vector<Guide> guides = world.guides(indirect ? isIndirectPhoton : isAreaPhoton);
        for (int way = 0; way < 4; ++way) {
            const float pdf = squareToGuidePdf(guides[block], world.frames[block].toLocal(ways[way]));
            if (way == (indirect ? 0 : 1))
                EXPECT_GT(pdf, 1.0f);
            else
                EXPECT_LT(pdf, 0.4f / (2 * kPi)) << way;
        }
    }
}

TEST(Guides, WithoutPhotonsAreUniform) {
    const World world{PhotonMap()};
    for (const Guide& guide : world.guides()) ASSERT_EQ(guide.weight, uniformGuide().weight);
    const ChosenDirections none = world.choose(Directions::photons, {}, 1);
    for (const float pdf : none.pdf) ASSERT_EQ(pdf, 0);
}

TEST(ChosenDirections, SameForAnyNumberOfThreads) {
    const World world(photonsOfField(10'000));
    std::vector<Guide> firstGuides;
    for (const Directions strategy : {Directions::guided, Directions::photons, Directions::nearestPhoton}) {
        ChosenDirections first;
        for (int threads : {1, 2, 8}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
            const std::vector<Guide> guides = world.guides();
            const ChosenDirections chosen = world.choose(strategy, guides, 5);
            if (threads == 1) {
                first = chosen;
                firstGuides = guides;
                continue;
            }
            for (size_t i = 0; i < guides.size(); ++i) ASSERT_EQ(guides[i].weight, firstGuides[i].weight);
            EXPECT_EQ(chosen.directionBlock, first.directionBlock);
            EXPECT_EQ(chosen.pdf, first.pdf);
            EXPECT_EQ(chosen.splatRadiance, first.splatRadiance);
        }
        EXPECT_NE(world.choose(strategy, firstGuides, 6).directionBlock, first.directionBlock);
        EXPECT_NE(world.choose(strategy, firstGuides, 5, 1).directionBlock, first.directionBlock);
    }
}

}  // namespace
}  // namespace phat
