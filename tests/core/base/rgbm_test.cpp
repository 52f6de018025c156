#include "core/base/rgbm.h"

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace phat {
namespace {

TEST(Rgbm, IsOffByHalfAStepOfItsRoot) {
    Rng rng(1);
    for (int i = 0; i < 100'000; ++i) {
        const float largest = std::exp(10 * rng.uniform() - 5), range = rgbmRange(largest);
        const glm::vec3 value =
            largest * glm::vec3(rng.uniform(), square(rng.uniform()), square(square(rng.uniform())));
        const glm::u8vec4 code = encodeRgbm(value, range);
        const glm::vec3 back = decodeRgbm(code, range);
        const float step = range * float(code.a) / 255 / 255;
        for (int c = 0; c < 3; ++c)
            ASSERT_LE(std::abs(std::sqrt(back[c]) - std::sqrt(value[c])), 0.501f * step);
        // The multiplier is as small as it may be, so that the largest channel uses what there is of 255.
        if (code.a <= 127) continue;
        ASSERT_GE(std::max({code.r, code.g, code.b}), 253);
        ASSERT_NEAR(maxComponent(back), maxComponent(value), maxComponent(value) / 250);
    }
}

TEST(Rgbm, HoldsItsRangeAndNothing) {
    EXPECT_EQ(encodeRgbm(glm::vec3(64), 8), glm::u8vec4(255));
    EXPECT_FLOAT_EQ(decodeRgbm(glm::u8vec4(255), 8).x, 64);
    EXPECT_EQ(decodeRgbm(encodeRgbm(glm::vec3(0), rgbmRange(0)), rgbmRange(0)), glm::vec3(0));
}

}  // namespace
}  // namespace phat
