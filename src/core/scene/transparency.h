#pragma once
// Whether rays may pass through surfaces.

#include <algorithm>
#include <vector>

#include "core/scene/scene.h"

namespace phat {

/// Whether any material is transparent; only then does RayScene evaluate opacity at hits.
inline bool hasTransparency(const Scene& scene) {
    return std::any_of(scene.materials.begin(), scene.materials.end(),
                       [](const Material& m) { return m.alphaMode != AlphaMode::opaque; });
}

/// Whether a material transmits light (KHR_materials_transmission). What shines does not.
inline bool isGlass(const Material& m) {
    return m.transmission > 0.0f && !m.unlit && m.emission == glm::vec3(0);
}

/// How light passes a surface.
enum class Glass : uint8_t {
    none,
    thin,    // straight on, attenuated along the material's thickness
    volume,  // refracted into the inside and out of it
};

/// [surface], or nothing where there is no glass; `materials` stand for those of the scene. Surfaces whose
/// material has a thickness bound a volume where those of their node close it; the others, single panes with
/// a thickness, count as thin.
std::vector<Glass> glassOfSurfaces(const Scene& scene, const std::vector<Material>& materials);

}  // namespace phat
