#pragma once
// A view for files without a camera.

#include "core/scene/lights.h"
#include "core/scene/rays.h"
#include "core/scene/scene.h"

namespace phat {

/// The field of view of a lens of 35 mm over a frame of 36 x 24 mm: 2 atan(12 / 35).
inline constexpr float kDefaultFovRadians = 0.660595f;

struct DefaultView {
    Camera camera;
    glm::vec3 target{0};  // a point in the middle of the view
    bool inside = false;
};

/// In a room: from the eye's height above its floor, level, from where most of it and of what stands in it is
/// seen and lit. Else from three quarters and above, as near as all of the scene but a ground plane fits. The
/// same for any number of threads, and for a scene in another unit.
DefaultView defaultView(const RayScene& rays, const LightSampler& lights);

Camera defaultCamera(const Scene& scene);

}  // namespace phat
