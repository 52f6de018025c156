#pragma once
// The exposure of `phat render`'s pictures.

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cli/render_camera.h"
#include "cli/render_options.h"
#include "core/base/image.h"
#include "core/scene/rays.h"

namespace phat {

inline constexpr float kMaxExposureStops = 40;

/// Declares --exposure: stops, or auto, which leaves `stops` empty.
void declareExposure(CLI::App& command, std::optional<float>& stops);

struct Exposure {
    float stops = 0;
    bool automatic = false;
    std::string causeOfBlack;  // why the picture shows no light at all; empty: it does
};

/// That of the flags or, if they leave it to the picture, the picture's own; none for linear pictures and for
/// counts.
Exposure exposureOf(const RenderOptions& options, const View& view, const Image& picture,
                    const RayScene& rays);

/// Adds it to a view's report, for pictures that have one.
void reportExposure(const RenderOptions& options, const Exposure& exposure, nlohmann::json& report);

/// "exposure +1.3 EV (auto)", and on a line of its own why the picture is black, if it is.
std::string describeExposure(const nlohmann::json& exposure);

}  // namespace phat
