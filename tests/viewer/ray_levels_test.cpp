#include "viewer/ray_levels.h"

#include <gtest/gtest.h>

namespace phat {
namespace {

constexpr int kLast = int(kRayLevels.size()) - 1;

TEST(RayLevels, RaysAreTheFirstToGo) {
    int level = 0;
    for (int frame = 0; frame < 10; ++frame) level = nextRayLevel(level, 0.02, 0.008);
    EXPECT_EQ(level, kLast);
    EXPECT_EQ(kRayLevels[size_t(level)].maxPerPixel, 0);
}

TEST(RayLevels, ComeBackWhenThereIsTime) {
    int level = kLast;
    for (int frame = 0; frame < 10; ++frame) level = nextRayLevel(level, 0.003, 0.008);
    EXPECT_EQ(level, 0);
}

// Each level costs twice the next one and something besides: the level must not swing.
TEST(RayLevels, SettleWhereTheFrameFits) {
    constexpr double kCost[] = {0.017, 0.009, 0.005, 0.003, 0.002};
    for (int first = 0; first <= kLast; ++first) {
        int level = first;
        for (int frame = 0; frame < 10; ++frame) level = nextRayLevel(level, kCost[level], 0.008);
        EXPECT_LE(kCost[level], 0.008);
        EXPECT_EQ(nextRayLevel(level, kCost[level], 0.008), level);
    }
}

TEST(RayLevels, EachHasFewerRays) {
    for (size_t i = 1; i < kRayLevels.size(); ++i)
        EXPECT_LT(kRayLevels[i].perNeighborhood, kRayLevels[i - 1].perNeighborhood);
}

}  // namespace
}  // namespace phat
