#include "cli/size_note.h"

#include <fmt/format.h>

#include "core/scene/enclosure.h"

namespace phat {

std::optional<std::string> sizeNote(const Scene& scene) {
    constexpr float kMaxMeters = 1000, kMinMeters = 0.05f;
    const auto across = [](const Bounds& bounds) { return maxComponent(bounds.high - bounds.low); };
    const Bounds all = boundsOf(scene);
    if (all.empty()) return {};
    // A house may stand on kilometres of ground.
    if (const float length = across(boundsWithoutGround(scene)); length > kMaxMeters)
        return fmt::format(
            "the scene is {:.3g} km across, and glTF's unit is the metre: exported in millimetres?",
            0.001f * length);
    if (const float length = across(all); length < kMinMeters)
        return fmt::format(
            "the scene is {:.3g} mm across, and glTF's unit is the metre: exported in another unit?",
            1000 * length);
    return {};
}

}  // namespace phat
