#pragma once
// Which step refines a picture next. It draws nothing and reads no clock.

#include <chrono>

namespace phat {

/// After the last change the picture waits so long before it is drawn with all pixels, where that is slow.
inline constexpr auto kSettleTime = std::chrono::milliseconds(150);
/// A picture that is there is not refined while the user acts: one more sample may take longer than a click.
inline constexpr auto kInputRestTime = std::chrono::milliseconds(150);
/// While lighting is updated, a picture by newer light is shown when it has so many samples a pixel: single
/// samples flicker.
inline constexpr int kNewerSamples = 4;

/// What has been drawn so far.
struct DrawnState {
    bool current = false;                // of the version that is wanted
    bool fullResolution = false;         // else it was drawn with fewer pixels
    bool traced = false;                 // with traced reflections
    bool lightIsCurrent = true;          // by the newest light
    int samples = 0, wantedSamples = 0;  // a pixel
};

/// What is wanted, and when it was last different.
struct RefineGoal {
    std::chrono::steady_clock::duration sinceChange{}, sinceInput{};
    bool mayTrace = false;     // reflections, once nothing moves
    int movingCoarseness = 1;  // window pixels a rendered pixel, each way, while something moves
    int samples = 1;           // a pixel, at rest
};

enum class RefineStep {
    done,       // nothing is left to do
    wait,       // for the user or the settle time
    restart,    // draw anew
    addSample,  // to what has been drawn
    relight,    // draw beside the shown picture, by the newest light
};

struct RefinePlan {
    RefineStep step = RefineStep::done;
    int coarseness = 1;
    bool trace = false;
    int samples = 1;
};

RefinePlan planRefinement(const DrawnState& drawn, const RefineGoal& goal);

}  // namespace phat
