#pragma once
// Irradiance of a bake as renderers read it that know nothing of PHATexels.

#include "core/atlas/atlas.h"
#include "core/base/progress.h"
#include "core/phatexel/phatexture.h"
#include "core/scene/lit_scene.h"

namespace phat {

/// Which light a lightmap has; each has that of the ones before it, too.
enum class LightmapLight : uint8_t {
    indirect,  // light after at least one reflection
    area,      // straight from emissive surfaces and the environment
    all,       // straight from punctual lights
};

/// Irradiance, W/m2, [y][x] of the atlas. Every texel of a chart's tiles has the value of the nearest one
/// that is known. `scene`: asked for rays by LightmapLight::all alone.
std::vector<glm::vec3> lightmapOf(const LitScene& scene, const Atlas& atlas, const TexelPoints& points,
                                  const Phatexture& phatexture, LightmapLight light, Progress& progress);

}  // namespace phat
