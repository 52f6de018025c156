#pragma once
// Input of light transport.

#include "core/scene/lights.h"
#include "core/scene/rays.h"

namespace phat {

/// A scene that can be asked for rays, and its lights. Both must outlive it.
struct LitScene {
    const RayScene& rays;
    const LightSampler& lights;
};

}  // namespace phat
