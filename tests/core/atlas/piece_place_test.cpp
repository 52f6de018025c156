// Places of small pieces in a chart of several.

#include "core/atlas/piece_place.h"

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace phat {
namespace {

// Over sizes from a hundredth of a texel to a hundred texels.
template <typename Check>
void forSizes(const Check& check) {
    Rng rng(7);
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec2 random = rng.uniform2();
        check(glm::dvec2(std::pow(100, 2 * random.x - 1), std::pow(100, 2 * random.y - 1)));
    }
    for (int whole = 1; whole < 40; ++whole) check(glm::dvec2(whole, whole + 1e-9));
}

// So that bilinear interpolation on a piece reads its place alone, but for a five-hundredth on narrow ones.
TEST(PiecePlace, HalfATexelIsFreeAroundAPiece) {
    for (const double freedom : {1.0, kPieceFreedom})
        forSizes([&](glm::dvec2 size) {
            const glm::uvec2 place = placeOf(size, freedom);
            const glm::dvec2 drawn = drawnSize(size, place, freedom);
            const glm::dvec2 low = drawnOrigin(drawn, place), high = low + drawn;
            for (int axis = 0; axis < 2; ++axis) {
                EXPECT_GE(low[axis], 0.498) << size[axis];
                EXPECT_LE(high[axis], place[axis] - 0.498) << size[axis];
            }
        });
}

TEST(PiecePlace, PiecesAreDrawnNearlyAsLargeAsTheyAre) {
    forSizes([&](glm::dvec2 size) {
        const glm::dvec2 exact = drawnSize(size, placeOf(size, 1), 1);
        const glm::dvec2 freely = drawnSize(size, placeOf(size, kPieceFreedom), kPieceFreedom);
        for (int axis = 0; axis < 2; ++axis) {
            if (isNarrow(size[axis])) continue;
            EXPECT_NEAR(exact[axis], size[axis], 1e-4);
            EXPECT_LE(std::max(freely[axis] / size[axis], size[axis] / freely[axis]), kPieceFreedom + 1e-3);
        }
    });
}

// Else the covered texels would not add up to the area.
TEST(PiecePlace, AsManyCentresAreOnAPieceAsItIsLong) {
    forSizes([](glm::dvec2 size) {
        const glm::uvec2 place = placeOf(size, kPieceFreedom);
        const glm::dvec2 drawn = drawnSize(size, place, kPieceFreedom), low = drawnOrigin(drawn, place);
        for (int axis = 0; axis < 2; ++axis) {
            const double centres = std::floor(low[axis] + drawn[axis] - 0.5) - std::ceil(low[axis] - 0.5) + 1;
            if (std::abs(size[axis] - std::round(size[axis])) < 1e-3) continue;  // rounding decides
            if (isNarrow(size[axis])) {
                EXPECT_EQ(centres, 1);
                continue;
            }
            const double most = size[axis] < 8 ? 0.75 : 0.501;  // those of few texels: squeezed or stretched
            EXPECT_NEAR(centres, size[axis], most);
            EXPECT_GE(centres, 1);
        }
    });
}

TEST(PiecePlace, NarrowPiecesTakeOneRow) {
    const glm::dvec2 size(0.7, 12);
    EXPECT_EQ(placeOf(size, 1), glm::uvec2(1, 14));
    EXPECT_EQ(drawnSize(size, {1, 14}, 1).x, kNarrowTexels);
    EXPECT_EQ(drawnSize({1e-4, 12}, {1, 14}, 1).x, 1e-4) << "wider than it is";
}

TEST(PiecePlace, ChartsOfTheirOwnAreWholeTilesWithAGutter) {
    EXPECT_EQ(texelsAlone({24, 40}, 4), 32 * 48);
    EXPECT_EQ(texelsTaken({24, 40}, 4), 32 * 48);
    EXPECT_EQ(texelsTaken({6, 40}, 4), 8 * 42);
}

}  // namespace
}  // namespace phat
