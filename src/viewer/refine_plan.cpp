#include "viewer/refine_plan.h"

#include <algorithm>

namespace phat {

RefinePlan planRefinement(const DrawnState& drawn, const RefineGoal& goal) {
    const bool settled = goal.sinceChange >= kSettleTime;
    const bool userActs = goal.sinceInput < kInputRestTime;
    RefinePlan plan;
    plan.coarseness = settled ? 1 : goal.movingCoarseness;
    plan.trace = settled && goal.mayTrace;
    plan.samples = plan.coarseness > 1 ? 1 : goal.samples;

    const bool final = drawn.current && drawn.fullResolution && drawn.traced == plan.trace &&
                       drawn.wantedSamples == goal.samples;
    if (final && drawn.lightIsCurrent && drawn.samples >= goal.samples)
        plan.step = RefineStep::done;
    else if (final && !drawn.lightIsCurrent && drawn.samples >= std::min(kNewerSamples, goal.samples))
        plan.step = userActs ? RefineStep::wait : RefineStep::relight;
    else if (drawn.current && (userActs || plan.coarseness > 1))
        plan.step = RefineStep::wait;  // a coarse picture is drawn once a change
    else if (!drawn.current || drawn.traced != plan.trace)
        plan.step = RefineStep::restart;
    else
        plan.step = RefineStep::addSample;
    return plan;
}

}  // namespace phat
