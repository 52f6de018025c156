// The panels' widgets by their labels, from the file that the window writes.

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "viewer/window_driver.h"

namespace phat {

std::optional<glm::ivec4> WindowDriver::areaOf(const std::string& label) const {
    const auto bytes = readBytes(folder_.file(kWidgetsFile));
    if (bytes.empty()) return {};
    for (const auto& entry : nlohmann::json::parse(bytes))
        if (entry[0] == label) return glm::ivec4(entry[1], entry[2], entry[3], entry[4]);
    return {};
}

glm::ivec2 WindowDriver::pixelOnWidget(const std::string& label, float fraction) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(600);
    for (;; wait(0.05)) {
        if (!running()) throw std::runtime_error("phat view ended: " + errors());
        if (std::chrono::steady_clock::now() > end) throw std::runtime_error("no widget " + label);
        const auto area = areaOf(label);
        if (!area) continue;
        const glm::ivec2 pixel(std::lround(glm::mix(float(area->x), float(area->z), fraction)),
                               (area->y + area->w) / 2);
        if (pixel.y >= 0 && pixel.y < size_.y) return pixel;
        moveTo({(area->x + area->z) / 2, size_.y / 2});
        wheel(pixel.y < 0 ? 1 : -1);
    }
}

void WindowDriver::clickWidget(const std::string& label, bool control) {
    click(pixelOnWidget(label, 0.5f), control);
}

}  // namespace phat
