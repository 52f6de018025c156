#include "cli/exposure.h"

#include <fmt/format.h>

#include "cli/render_files.h"
#include "core/render/auto_exposure.h"

namespace phat {

using nlohmann::json;

namespace {

// Why a picture of all light is black; empty: it is not.
std::string causeOfBlack(const RenderOptions& options, const View& view, const Image& picture,
                         const RayScene& rays) {
    const auto shines = [](const glm::vec3& pixel) { return maxComponent(pixel) > 0; };
    if (options.component != Component::all || std::ranges::any_of(picture.pixels, shines)) return "";
    return meteredPixels(rays, view.camera, view.width, view.height).empty()
               ? "the camera sees no surface; --eye and --target choose another view"
               : "no light reaches what the camera sees; phat info lists the lights";
}

}  // namespace

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
    if (options.countReads) return {options.exposureStops.value_or(0), false, ""};
    const std::string cause = causeOfBlack(options, view, picture, rays);
    if (options.exposureStops) return {*options.exposureStops, false, cause};
    return {autoExposureStops(picture, meteredPixels(rays, view.camera, view.width, view.height)), true,
            cause};
}

void reportExposure(const RenderOptions& options, const Exposure& exposure, json& report) {
    if (isLinear(options.output)) return;
    // As it is printed: a float's nearest double has more digits than were meant.
    const double stops = std::stod(fmt::format("{}", exposure.stops));
    report["exposure"] = {{"stops", stops}, {"auto", exposure.automatic}};
    if (!exposure.causeOfBlack.empty()) report["exposure"]["black"] = exposure.causeOfBlack;
}

std::string describeExposure(const json& exposure) {
    const std::string stops = fmt::format("exposure {:+.1f} EV{}", exposure["stops"].get<double>(),
                                          exposure["auto"].get<bool>() ? " (auto)" : "");
    if (!exposure.contains("black")) return stops;
    return fmt::format("{}\nthe picture is black: {}", stops, exposure["black"].get<std::string>());
}

}  // namespace phat
