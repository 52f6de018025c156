#include "core/atlas/area_points.h"

#include <gtest/gtest.h>

namespace phat {
namespace {

// A triangle has its share of the points, to within one, and they are in it and all over it.
TEST(AreaPoints, AreSpacedByAreaAndInTheirTriangles) {
    constexpr double kLegs[] = {1, 0.1, 3, 0.5, 2};
    constexpr int kCount = 2000;
    double total = 0;
    for (const double leg : kLegs) total += 0.5 * leg * leg;
    AreaPoints points(kCount, total);
    double passed = 0;
    for (uint32_t t = 0; t < std::size(kLegs); ++t) {
        const double leg = kLegs[t];
        const glm::dvec3 corner(10.0 * t, 1, 0);
        glm::dvec3 sum(0);
        const auto here =
            points.next({corner, corner + glm::dvec3(leg, 0, 0), corner + glm::dvec3(0, leg, 0)}, {7, t});
        for (const AreaPoint& point : here) {
            const glm::dvec3 p = point.position - corner;
            EXPECT_TRUE(p.x >= 0 && p.y >= 0 && p.x + p.y <= leg && p.z == 0) << p.x << ' ' << p.y;
            sum += p;
        }
        EXPECT_NEAR(double(here.size()), kCount * 0.5 * leg * leg / total, 1);
        // A coordinate's variance in a right triangle is leg^2 / 18; five standard deviations of the mean.
        if (!here.empty()) {
            EXPECT_NEAR(sum.x / double(here.size()), leg / 3,
                        5 * leg / std::sqrt(18.0 * double(here.size())));
            EXPECT_NEAR(sum.y / double(here.size()), leg / 3,
                        5 * leg / std::sqrt(18.0 * double(here.size())));
        }
        passed += 0.5 * leg * leg;
        EXPECT_NEAR(points.visited(), kCount * passed / total, 0.5 + 1e-9);
    }
    EXPECT_EQ(points.visited(), kCount);
}

TEST(AreaPoints, TheSameSeedGivesTheSamePoints) {
    const std::array<glm::dvec3, 3> corners = {glm::dvec3(0), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)};
    const auto of = [&](glm::uvec2 seed) { return AreaPoints(4, 0.5).next(corners, seed); };
    const auto first = of({1, 2});
    ASSERT_EQ(first.size(), 4u);
    EXPECT_EQ(first[3].position, of({1, 2})[3].position);
    EXPECT_NE(first[3].position, of({1, 3})[3].position);
    EXPECT_NE(first[3].seed, first[2].seed);
}

}  // namespace
}  // namespace phat
