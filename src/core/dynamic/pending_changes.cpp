#include "core/dynamic/pending_changes.h"

namespace phat {
namespace {

// The number of punctual lights for which a ray's end is tested for occlusion or disocclusion by a change;
// more would cost more than the rays.
constexpr size_t kMaxShadowLights = 4;
// Stored distances are right to 5.6 % (packDistance).
constexpr float kDistanceMargin = 1.06f;
// An object occludes texels inside its box, or within this fraction of its size outside.
constexpr float kCoverReach = 0.1f;

// Whether the segment meets the box. source: Williams et al. 2005, "An Efficient and Robust Ray-Box
// Intersection Algorithm".
bool meets(const Bounds& box, glm::vec3 origin, glm::vec3 direction, float distance) {
    const glm::vec3 inverse = 1.0f / direction;
    const glm::vec3 a = (box.low - origin) * inverse, b = (box.high - origin) * inverse;
    const glm::vec3 near = glm::min(a, b), far = glm::max(a, b);
    const float from = std::max({near.x, near.y, near.z, 0.0f});
    const float to = std::min({far.x, far.y, far.z, distance});
    return from <= to;  // false for the 0 * infinity of a ray in a face's plane; boxes are widened for it
}

Bounds widened(const Bounds& box, float by) {
    return {box.low - by, box.high + by};
}

bool contains(const Bounds& box, glm::vec3 point) {
    return glm::all(glm::greaterThanEqual(point, box.low)) && glm::all(glm::lessThanEqual(point, box.high));
}

}  // namespace

PendingChanges::PendingChanges(const BakerState& state, size_t tile) {
    const uint64_t updated = state.tileScene[tile];
    moved_ = state.scene.movedAt(state.scene.atlas().tileChart[tile]) > updated;
    for (const SceneChange& change : state.scene.changes()) {
        if (change.version <= updated) continue;
        const bool surface = change.kind == SceneChange::Kind::surface;
        (surface ? surfaceBoxes_ : lightBoxes_).push_back(widened(change.box, 1e-3f * change.box.diagonal()));
    }
}

bool PendingChanges::mayCover(const TilePatch& patch) const {
    if (moved_) return true;
    const float reach = 0.5f * float(kTileSize) * (glm::length(patch.alongX) + glm::length(patch.alongY));
    return std::any_of(surfaceBoxes_.begin(), surfaceBoxes_.end(), [&](const Bounds& box) {
        return contains(widened(box, reach + kCoverReach * box.diagonal()), patch.center);
    });
}

bool PendingChanges::affectRay(const Scene& scene, glm::vec3 origin, glm::vec3 direction,
                               float stored) const {
    const float distance = stored * kDistanceMargin;
    const size_t lights = std::min(scene.lights.size(), kMaxShadowLights);
    for (const Bounds& box : surfaceBoxes_) {
        if (meets(box, origin, direction, distance)) return true;
        if (stored >= kFarDistance) continue;
        const glm::vec3 end = origin + stored * direction;
        for (size_t i = 0; i < lights; ++i) {
            const PunctualLight& light = scene.lights[i];
            const bool parallel = light.type == PunctualLight::Type::directional;
            const glm::vec3 towardLight = parallel ? -light.direction : light.position - end;
            const float length = glm::length(towardLight);
            if (length > 0 && meets(box, end, towardLight / length, parallel ? kFarDistance : length))
                return true;
        }
    }
    if (stored >= kFarDistance) return false;
    // A changed light matters where it shines on the ray's end.
    const glm::vec3 end = origin + stored * direction;
    return std::any_of(lightBoxes_.begin(), lightBoxes_.end(), [&](const Bounds& box) {
        return contains(widened(box, (kDistanceMargin - 1) * stored), end);
    });
}

}  // namespace phat
