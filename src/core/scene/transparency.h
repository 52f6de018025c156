#pragma once
// Whether rays may pass through surfaces.

#include <algorithm>

#include "core/scene/scene.h"

namespace phat {

/// Whether any material is transparent; only then does RayScene evaluate opacity at hits.
inline bool hasTransparency(const Scene& scene) {
    return std::any_of(scene.materials.begin(), scene.materials.end(),
                       [](const Material& m) { return m.alphaMode != AlphaMode::opaque; });
}

}  // namespace phat
