#pragma once
// Depth pictures from every punctual light, made anew when lights or things have moved.

#include <span>
#include <vector>

#include "core/scene/scene.h"
#include "gl/gl_objects.h"
#include "gl/scene_upload.h"

namespace phat {

struct ShadowMaps {
    GlTexture depth;        // DEPTH32F array with comparison; one layer even without lights
    GlTexture tints;        // RGBA32F array, a quarter of the size: of glass; empty where there is none
    GlTexture depthValues;  // a view of `depth` without comparison; empty where no light is a disc
    GlTexture lightTable;   // see shaders/lib/lights.glsl
    int lightCount = 0;
};

struct ShadowPrograms {
    ShaderProgram depth;
    ShaderProgram tints;  // empty where there is no glass
};

/// Whether a light has a penumbra: SUN_DISC of shaders/lib/lights.glsl.
bool hasDisc(const std::vector<PunctualLight>& lights);

/// Surfaces that cast shadows.
struct ShadowCasters {
    const GpuScene& scene;
    DrawnMaterials materials;
};

/// Six layers for a point light or a wide cone, one for a narrow one or a directional light. Throws GlError.
ShadowMaps renderShadowMaps(const std::vector<PunctualLight>& lights, std::span<const ShadowCasters> casters,
                            const ShadowPrograms& programs);

}  // namespace phat
