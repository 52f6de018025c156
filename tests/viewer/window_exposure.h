#pragma once
// The exposure that the window chooses.

#include <string>

#include "viewer/viewer_state.h"

namespace phat {

/// When it opens `path`.
inline std::string windowExposure(const std::string& path) {
    ViewerState state;
    state.document = std::make_unique<Document>(path, SceneLighting());
    showFirstView(state);
    return std::to_string(state.view.exposureStops);
}

}  // namespace phat
