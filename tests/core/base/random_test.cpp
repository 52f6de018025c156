#include "core/base/random.h"

#include <gtest/gtest.h>

#include <bit>
#include <set>

#include "support/chi_squared.h"

namespace phat {
namespace {

// Published outputs for seed 0: the state after each step is a multiple of the golden gamma.
TEST(Random, MixIsSplitmix64) {
    constexpr uint64_t kGamma = 0x9e3779b97f4a7c15ull;
    EXPECT_EQ(mixBits(kGamma), 0xe220a8397b1dcdafull);
    EXPECT_EQ(mixBits(2 * kGamma), 0x6e789e6aa1b965f4ull);
    EXPECT_EQ(mixBits(3 * kGamma), 0x06c45d188009454full);
}

// Flipping one bit of any input flips each output bit half the time: over 64 bits x 500 inputs a mean of 32
// with a standard deviation of 4 / sqrt(500 * 64) = .022.
TEST(Random, HashAvalanches) {
    Rng rng(1);
    for (int argument = 0; argument < 3; ++argument) {
        double flipped = 0;
        for (int i = 0; i < 500; ++i) {
            uint64_t in[3] = {rng.bits(), rng.bits(), rng.bits()};
            const uint64_t before = hashOf(in[0], in[1], in[2]);
            const uint64_t original = in[argument];
            for (int bit = 0; bit < 64; ++bit) {
                in[argument] = original ^ (uint64_t(1) << bit);
                flipped += std::popcount(before ^ hashOf(in[0], in[1], in[2]));
            }
        }
        EXPECT_NEAR(flipped / (500 * 64), 32, 0.1) << argument;
    }
}

TEST(Random, ArgumentsOfAHashAreNotInterchangeable) {
    std::set<uint64_t> hashes;
    for (uint64_t a = 0; a < 20; ++a)
        for (uint64_t b = 0; b < 20; ++b)
            for (uint64_t c = 0; c < 20; ++c) hashes.insert(hashOf(a, b, c));
    EXPECT_EQ(hashes.size(), 8000u);
}

// Neighbouring seeds are what stages use: their first numbers must be as good as one stream's.
TEST(Random, UniformPairsFillTheSquare) {
    constexpr int kSide = 16, kSamples = 100'000;
    const std::vector<double> expected(kSide * kSide, double(kSamples) / (kSide * kSide));
    const auto test = [&](auto&& next) {
        std::vector<double> counts(kSide * kSide, 0.0);
        for (int i = 0; i < kSamples; ++i) {
            const glm::vec2 p = next(i);
            ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
            counts[size_t(p.y * kSide) * kSide + size_t(p.x * kSide)] += 1;
        }
        const test::ChiSquared result = test::chiSquared(counts, expected);
        EXPECT_LT(result.value, result.limit);
        // Too even is not random either: as unlikely on the other side.
        EXPECT_GT(result.value, 2 * result.degreesOfFreedom - result.limit);
    };
    Rng stream(7);
    test([&](int) { return stream.uniform2(); });
    test([](int i) { return Rng(uint64_t(i)).uniform2(); });
    test([](int i) { return Rng(hashOf(3, 5, uint64_t(i))).uniform2(); });
}

TEST(Random, StreamsAreValues) {
    Rng a(5);
    a.bits();
    Rng b = a;
    for (int i = 0; i < 100; ++i) ASSERT_EQ(a.bits(), b.bits());
    EXPECT_NE(Rng(5).bits(), Rng(6).bits());
}

TEST(Random, MortonInterleaves) {
    EXPECT_EQ(morton(1, 0), 1u);
    EXPECT_EQ(morton(0, 1), 2u);
    EXPECT_EQ(morton(0xffff, 0), 0x55555555u);
    EXPECT_EQ(morton(0, 0xffff), 0xaaaaaaaau);
    Rng rng(2);
    for (int i = 0; i < 10'000; ++i) {
        const uint32_t x = rng.bits() & 0xffff, y = rng.bits() & 0xffff;
        const uint32_t code = morton(x, y);
        for (int bit = 0; bit < 16; ++bit) {
            ASSERT_EQ((code >> (2 * bit)) & 1, (x >> bit) & 1);
            ASSERT_EQ((code >> (2 * bit + 1)) & 1, (y >> bit) & 1);
        }
        ASSERT_EQ(mortonDecode(code), glm::uvec2(x, y));
    }
}

TEST(Random, ReverseBits) {
    EXPECT_EQ(reverseBits(0b1, 1), 0b1u);
    EXPECT_EQ(reverseBits(0b0000000001, 10), 0b1000000000u);
    EXPECT_EQ(reverseBits(0b1100000010, 10), 0b0100000011u);
    EXPECT_EQ(reverseBits(1u, 32), 0x80000000u);
    for (uint32_t i = 0; i < 1024; ++i) ASSERT_EQ(reverseBits(reverseBits(i, 10), 10), i);
}

}  // namespace
}  // namespace phat
