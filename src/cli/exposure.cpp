#include "cli/exposure.h"

#include <fmt/format.h>

#include "cli/render_files.h"
#include "core/render/auto_exposure.h"

namespace phat {

using nlohmann::json;

void declareExposure(CLI::App& command, std::optional<float>& stops) {
    command
        .add_option_function<std::string>(
            "--exposure",
            [&stops](const std::string& text) {
                stops.reset();
                if (text == "auto") return;
                char* end = nullptr;
                const float value = std::strtof(text.c_str(), &end);
                if (text.empty() || *end != 0 || !(std::abs(value) <= kMaxExposureStops))
                    throw CLI::ValidationError(
                        "--exposure", fmt::format("\"{}\" is neither auto nor a number from {} to {}", text,
                                                  -kMaxExposureStops, kMaxExposureStops));
                stops = value;
            },
            "Stops, for .png and .jpg, or auto: middle grey for what is lit")
        ->type_name("EV")
        ->default_str("auto");
}

Exposure exposureOf(const RenderOptions& options, const View& view, const Image& picture,
                    const RayScene& rays) {
    if (isLinear(options.output)) return {};
    if (options.exposureStops) return {*options.exposureStops, false};
    if (options.countReads) return {};
    return {autoExposureStops(picture, meteredPixels(rays, view.camera, view.width, view.height)), true};
}

void reportExposure(const RenderOptions& options, const Exposure& exposure, json& report) {
    if (isLinear(options.output)) return;
    // As it is printed: a float's nearest double has more digits than were meant.
    const double stops = std::stod(fmt::format("{}", exposure.stops));
    report["exposure"] = {{"stops", stops}, {"auto", exposure.automatic}};
}

std::string describeExposure(const json& exposure) {
    return fmt::format("exposure {:+.1f} EV{}", exposure["stops"].get<double>(),
                       exposure["auto"].get<bool>() ? " (auto)" : "");
}

}  // namespace phat
