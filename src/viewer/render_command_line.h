#pragma once
// The view in the window as a command.

#include <string>

#include "viewer/viewer_state.h"

namespace phat {

/// `phat render` with the flags that make the left picture, quoted for a POSIX shell. A view without a camera
/// of the file keeps its eye and its target, not a roll; edited lights and environments have no flag. pre:
/// the left picture is of light.
std::string renderCommandLine(const ViewerState& state, glm::ivec2 size);

}  // namespace phat
