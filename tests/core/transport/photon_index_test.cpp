#include <gtest/gtest.h>

#include "core/transport/photon_map.h"

namespace phat {
namespace {

using Neighbors = std::vector<PhotonIndex::Neighbor>;

// Half of them on a coarse lattice, so that equal distances and equal places are everywhere.
std::vector<Photon> randomPhotons(size_t count, uint64_t seed) {
    Rng rng(seed);
    std::vector<Photon> photons(count);
    for (size_t i = 0; i < count; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            const float u = rng.uniform();
            photons[i].position[axis] = i % 2 ? u : std::floor(u * 8) / 8;
        }
    }
    return photons;
}

Neighbors bruteForce(const std::vector<Photon>& photons, glm::vec3 position, uint32_t k, float radius,
                     bool (*accept)(uint32_t)) {
    Neighbors all;
    for (uint32_t i = 0; i < photons.size(); ++i) {
        const glm::vec3 d = position - photons[i].position;
        const float distanceSquared = glm::dot(d, d);
        if (distanceSquared <= radius * radius && accept(i)) all.push_back({i, distanceSquared});
    }
    std::sort(all.begin(), all.end(), [](auto& a, auto& b) {
        return std::pair(a.distanceSquared, a.photon) < std::pair(b.distanceSquared, b.photon);
    });
    if (all.size() > k) all.resize(k);
    return all;
}

void expectSame(const Neighbors& found, const Neighbors& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (size_t i = 0; i < found.size(); ++i) {
        ASSERT_EQ(found[i].photon, expected[i].photon) << i;
        ASSERT_EQ(found[i].distanceSquared, expected[i].distanceSquared) << i;
    }
}

TEST(PhotonIndex, FindsWhatBruteForceFinds) {
    const auto any = [](uint32_t) { return true; };
    const auto everyThird = [](uint32_t i) { return i % 3 == 0; };
    Neighbors found;
    for (size_t count : {0, 1, 2, 17, 3000}) {
        const std::vector<Photon> photons = randomPhotons(count, count);
        const PhotonIndex index(photons);
        Rng rng(99);
        for (int query = 0; query < 1500; ++query) {
            glm::vec3 position(rng.uniform(), rng.uniform(), rng.uniform());
            if (query % 3 == 0) position = glm::floor(position * 8.0f) / 8.0f;
            if (query % 7 == 0) position = position * 5.0f - 2.0f;
            const uint32_t k = uint32_t(rng.uniform() * 60);
            // From next to nothing to everything; .125 ends exactly on lattice neighbours.
            const float radii[] = {1e-4f, 0.125f, 0.3f, 10.0f, 1e30f};
            const float radius = radii[query % 5];
            index.nearest(position, k, radius, found);
            expectSame(found, bruteForce(photons, position, k, radius, any));
            index.nearest(position, k, radius, everyThird, found);
            expectSame(found, bruteForce(photons, position, k, radius, everyThird));

            index.within(position, radius, found);
            Neighbors all = bruteForce(photons, position, ~0u, radius, any);
            std::sort(all.begin(), all.end(), [](auto& a, auto& b) { return a.photon < b.photon; });
            expectSame(found, all);
        }
    }
}

TEST(PhotonIndex, ManyInOnePlace) {
    std::vector<Photon> photons(5000);
    for (Photon& photon : photons) photon.position = {1, 2, 3};
    const PhotonIndex index(photons);
    Neighbors found;
    index.nearest({1, 2, 3}, 10, 0.0f, found);
    ASSERT_EQ(found.size(), 10u);
    for (uint32_t i = 0; i < 10; ++i) EXPECT_EQ(found[i].photon, i);
    index.within({1, 2, 3}, 0.0f, found);
    EXPECT_EQ(found.size(), 5000u);
    index.nearest({1, 2, 4}, 10, 0.999f, found);
    EXPECT_TRUE(found.empty());
}

TEST(PhotonIndex, MovesWithItsTree) {
    const std::vector<Photon> photons = randomPhotons(100, 5);
    PhotonIndex first(photons);
    const PhotonIndex index = std::move(first);
    Neighbors found;
    index.nearest({0.5f, 0.5f, 0.5f}, 3, 10, found);
    EXPECT_EQ(found.size(), 3u);
}

}  // namespace
}  // namespace phat
