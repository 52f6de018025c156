#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/phatexel/phatexture.h"
#include "support/direction_density.h"

namespace phat {
namespace {

TEST(GuideSampling, FollowsItsDensity) {
    Rng rng(1);
    std::array<float, kGuideCells> cells{};
    for (float& cell : cells) cell = std::exp2(5 * rng.uniform());
    for (const Guide& guide : {makeGuide(cells, 0.3f), uniformGuide(), cosineGuide()})
        expectSamplesFollowDensity([&] { return squareToGuide(guide, rng.uniform2()); },
                                   [&](glm::vec3 d) { return squareToGuidePdf(guide, d); });
}

}  // namespace
}  // namespace phat
