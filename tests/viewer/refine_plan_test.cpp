#include "viewer/refine_plan.h"

#include <gtest/gtest.h>

namespace phat {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// A still picture of 16 samples with traced reflections.
const DrawnState kFinished{true, true, true, true, 16, 16};
const RefineGoal kAtRest{seconds(1), seconds(1), true, 4, 16};

TEST(RefinePlan, AFinishedPictureRests) {
    EXPECT_EQ(planRefinement(kFinished, kAtRest).step, RefineStep::done);
}

TEST(RefinePlan, AChangeIsDrawnAtOnceAndCoarse) {
    DrawnState drawn = kFinished;
    drawn.current = false;
    RefineGoal goal = kAtRest;
    goal.sinceChange = goal.sinceInput = milliseconds(0);
    const RefinePlan plan = planRefinement(drawn, goal);
    EXPECT_EQ(plan.step, RefineStep::restart);
    EXPECT_EQ(plan.coarseness, 4);
    EXPECT_EQ(plan.samples, 1);
    EXPECT_FALSE(plan.trace);
}

TEST(RefinePlan, ACoarsePictureWaitsUntilTheSettleTimeIsOver) {
    const DrawnState coarse{true, false, false, true, 1, 1};
    RefineGoal goal = kAtRest;
    goal.sinceChange = kSettleTime - milliseconds(1);
    EXPECT_EQ(planRefinement(coarse, goal).step, RefineStep::wait);
    goal.sinceChange = kSettleTime;
    const RefinePlan plan = planRefinement(coarse, goal);
    EXPECT_EQ(plan.step, RefineStep::restart);
    EXPECT_EQ(plan.coarseness, 1);
    EXPECT_TRUE(plan.trace);
}

TEST(RefinePlan, SamplesAreAddedOnlyWhileTheUserRests) {
    DrawnState drawn = kFinished;
    drawn.samples = 3;
    RefineGoal goal = kAtRest;
    EXPECT_EQ(planRefinement(drawn, goal).step, RefineStep::addSample);
    goal.sinceInput = kInputRestTime - milliseconds(1);
    EXPECT_EQ(planRefinement(drawn, goal).step, RefineStep::wait);
}

TEST(RefinePlan, NewerLightIsDrawnBesideAPictureWithEnoughSamples) {
    DrawnState drawn = kFinished;
    drawn.lightIsCurrent = false;
    EXPECT_EQ(planRefinement(drawn, kAtRest).step, RefineStep::relight);
    drawn.samples = kNewerSamples - 1;
    EXPECT_EQ(planRefinement(drawn, kAtRest).step, RefineStep::addSample);
}

}  // namespace
}  // namespace phat
