#pragma once
// How many rays the frames of a moving view trace, so that they stay within their time. It reads no clock.

#include <array>

#include "gl/renderer.h"

namespace phat {

/// From the most rays to none, where reflections are looked up.
inline constexpr std::array<RayBudget, 5> kRayLevels = {
    {{24, 8, 2}, {16, 8, 1}, {8, 4, 1}, {4, 2, 1}, {0, 0, 0}}};
/// Of the first frame.
inline constexpr int kFirstRayLevel = 1;

/// The next frame's level, an index of kRayLevels. `seconds`: of all passes of the last one, drawn at
/// `level`; `budget`: what a frame may take. A frame at one level takes up to twice what it takes at the
/// next, so that a level is only gone back to from half of the budget.
int nextRayLevel(int level, double seconds, double budget);

}  // namespace phat
