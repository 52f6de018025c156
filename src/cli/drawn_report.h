#pragma once
// The --json report of an image drawn by OpenGL.

#include <nlohmann/json.hpp>
#include <span>

#include "cli/render_camera.h"
#include "cli/render_options.h"
#include "gl/traced_frame.h"

namespace phat {

/// `gpu`: its name. `seconds` by pass, so that more can be added.
nlohmann::json drawnReport(const RenderOptions& options, const View& view, const FrameTimes& times,
                           const ReflectionCost& cost, const std::string& gpu);

/// Of pictures of Inspected::reads: mean and most of the reads a pixel, by source of light.
nlohmann::json readsReport(std::span<const Image> pictures);

}  // namespace phat
