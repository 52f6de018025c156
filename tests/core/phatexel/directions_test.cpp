#include "core/phatexel/directions.h"

#include <gtest/gtest.h>

#include <set>

#include "core/base/random.h"

namespace phat {
namespace {

// Every aligned 2^k x 2^k group of texels has one sample in each of the 2^k x 2^k coarse cells.
TEST(StratifiedSquare, EveryAlignedGroupIsStratified) {
    for (const uint32_t scramble : {0u, 357u, 1023u}) {
        for (uint32_t group = 1; group <= kBlockSize; group *= 2) {
            for (uint32_t y0 = 0; y0 < kBlockSize; y0 += group) {
                for (uint32_t x0 = 0; x0 < kBlockSize; x0 += group) {
                    std::set<std::pair<int, int>> cells;
                    for (uint32_t i = 0; i < group * group; ++i) {
                        const glm::vec2 s =
                            stratifiedSquare({x0 + i % group, y0 + i / group}, scramble, {0.5f, 0.5f});
                        cells.insert({int(s.x * float(group)), int(s.y * float(group))});
                    }
                    ASSERT_EQ(cells.size(), size_t(group) * group);
                }
            }
        }
    }
}

TEST(StratifiedSquare, JitterStaysInTheCell) {
    const glm::vec2 low = stratifiedSquare({7, 21}, 99, {0, 0});
    const glm::vec2 high = stratifiedSquare({7, 21}, 99, {0.999f, 0.999f});
    EXPECT_LT(high.x - low.x, 1.0f / kBlockSize);
    EXPECT_LT(high.y - low.y, 1.0f / kBlockSize);
}

}  // namespace
}  // namespace phat
