#pragma once
// Irradiance of a bake as renderers read it that know nothing of PHATexels.

#include <optional>

#include "core/atlas/atlas.h"
#include "core/base/progress.h"
#include "core/phatexel/phatexture.h"
#include "core/render/irradiance_terms.h"
#include "core/scene/lit_scene.h"

namespace phat {

/// Which light a lightmap has; each has that of the ones before it, too.
enum class LightmapLight : uint8_t {
    indirect,  // light after at least one reflection
    area,      // straight from emissive surfaces and the environment
    all,       // straight from punctual lights
};

/// What a lightmap is made of. All outlive it.
struct LightmapInput {
    const Scene& scene;
    const Atlas& atlas;
    const TexelPoints& points;
    const Phatexture& phatexture;
};

/// Every texel of a chart's tiles has the values of the nearest one that is known.
struct Lightmap {
    std::vector<glm::vec3> irradiance;  // W/m2, [y][x] of the atlas
    /// If asked for: the same of any normal. That of a texel's own normal is `irradiance`.
    std::optional<IrradianceTerms> byNormal;
};
Lightmap lightmapOf(const LightmapInput& input, LightmapLight light, bool byNormal, Progress& progress);

}  // namespace phat
