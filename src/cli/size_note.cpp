#include "cli/size_note.h"

#include <fmt/format.h>

#include "core/scene/enclosure.h"

namespace phat {

std::optional<std::string> sizeNote(const Scene& scene) {
    constexpr float kMaxMeters = 1000, kMinMeters = 0.05f;
    const auto across = [](const Bounds& bounds) { return maxComponent(bounds.high - bounds.low); };
    const Bounds all = boundsOf(scene);
    if (all.empty()) return {};
    constexpr float kFloatStep = 0x1p-23f, kMaxStep = 1e-3f;  // of the scene
    const float farthest = maxComponent(glm::max(glm::abs(all.low), glm::abs(all.high)));
    if (kFloatStep * farthest > kMaxStep * all.diagonal())
        return fmt::format(
            "the scene is {:.0f} km from its origin, where positions are exact to {:.0f} mm: move it there",
            0.001f * farthest, 1000 * kFloatStep * farthest);
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
