#include "core/base/sobol.h"

#include <gtest/gtest.h>

#include <set>

namespace phat {
namespace {

// Cell of a 2^bitsX x 2^bitsY grid.
uint32_t cellOf(float x, float y, int bitsX, int bitsY) {
    return (uint32_t(x * float(1 << bitsX)) << bitsY) | uint32_t(y * float(1 << bitsY));
}

// A (0,2)-net in its first two dimensions: one point in each of 2^k cells of every shape, in all aligned
// runs.
TEST(ShuffledSobol, AlignedRunsAreStratified) {
    for (uint64_t seed : {1u, 77u})
        for (int k = 1; k <= 8; ++k)
            for (uint32_t run : {0u, 3u})
                for (int bitsX = 0; bitsX <= k; ++bitsX) {
                    std::set<uint32_t> cells;
                    for (uint32_t i = 0; i < 1u << k; ++i) {
                        const glm::vec4 p = shuffledSobol4((run << k) + i, seed);
                        cells.insert(cellOf(p.x, p.y, bitsX, k - bitsX));
                    }
                    ASSERT_EQ(cells.size(), size_t(1) << k);
                }
}

TEST(ShuffledSobol, EachDimensionIsStratified) {
    for (int d = 0; d < 4; ++d) {
        std::set<uint32_t> cells;
        for (uint32_t i = 0; i < 256; ++i) {
            const float x = shuffledSobol4(i, 5)[d];
            ASSERT_GE(x, 0.0f);
            ASSERT_LT(x, 1.0f);
            cells.insert(uint32_t(x * 256));
        }
        EXPECT_EQ(cells.size(), 256u);
    }
}

// Sets under different seeds are paired by chance. Without the shuffle points of the same index would be; of
// 4096 products of two uniform numbers the mean has a standard error of .0013 of independent ones.
TEST(ShuffledSobol, SetsAreUncorrelated) {
    double product = 0, sum = 0;
    std::set<uint32_t> cells;
    constexpr int kCount = 4096;
    for (uint32_t i = 0; i < kCount; ++i) {
        const double x = double(shuffledSobol4(i, 11).x), y = double(shuffledSobol4(i, 12).x);
        product += (x - 0.5) * (y - 0.5) / kCount;
        sum += x / kCount;
        if (i < 64) cells.insert(cellOf(float(x), float(y), 3, 3));
    }
    EXPECT_NEAR(sum, 0.5, 1e-3);
    EXPECT_NEAR(product, 0, 4 * 0.0013);
    // 64 random points in 64 cells: 1 - 1/e of them are met, 40 +- 3.
    EXPECT_NEAR(double(cells.size()), 40, 12);
}

// Over the seeds every point is uniform: the mean of x^2 is 1/3.
TEST(ShuffledSobol, PointsAreUniformOverTheSeeds) {
    for (uint32_t index : {0u, 1u, 5u, 65535u})
        for (int d = 0; d < 4; ++d) {
            double sum = 0;
            constexpr int kSeeds = 20'000;
            for (uint64_t seed = 0; seed < kSeeds; ++seed) {
                const double x = double(shuffledSobol4(index, seed)[d]);
                sum += x * x / kSeeds;
            }
            EXPECT_NEAR(sum, 1.0 / 3, 4 * 0.298 / std::sqrt(double(kSeeds))) << index << ' ' << d;
        }
}

}  // namespace
}  // namespace phat
