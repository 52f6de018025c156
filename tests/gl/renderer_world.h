#pragma once
// Small scenes of quads with an atlas and PHATexels made by hand, for the renderer's tests.

#include <functional>
#include <memory>
#include <string>

#include "core/atlas/atlas.h"
#include "core/base/random.h"
#include "core/phatexel/phatexture.h"
#include "gl/gl_context.h"
#include "gl/renderer.h"
#include "support/scene_builder.h"

namespace phat::test {

inline const std::string kShaderFolder = PHAT_SOURCE_DIR "/shaders";

/// All that a Renderer is made of.
struct RendererWorld {
    Scene scene;
    Atlas atlas;
    TexelPoints points;
    Phatexture phatexture;

    RendererInput input() const { return {scene, atlas, points, phatexture}; }
};

/// Gives every surface of `scene` (each one addQuad) a square chart of `tiles` x `tiles` tiles, side by side
/// in one row without a gap; the outer four texels of a chart are its gutter. PHATexels are all invalid and
/// the irradiance is zero.
RendererWorld worldOfQuads(Scene scene, uint32_t tiles);

/// Fills the PHATexels of one surface's chart: directions drawn from `guide`, values by `light`.
using LightAt = std::function<glm::vec3(glm::vec3 position, glm::vec3 directionWorld)>;
void fillPhatexels(RendererWorld& world, uint32_t surface, const LightAt& light,
                   float distance = kFarDistance);

/// PHATexels of all charts in the order that bakes have them in, which is what can be looked up.
PhatexelLayer layerInBakedOrder(const RendererWorld& world, const LightAt& light,
                                float distance = kFarDistance);

/// The tables that are read beside the PHATexels: made with the world, and anew where its layers are others.
void prepareLookup(RendererWorld& world);

/// Of the colour of gold.
Material metal(float roughness);

/// A guide whose cells differ by up to 1:8, the same for every seed.
Guide bumpyGuide(uint64_t seed);

/// Looks from `eye` at `target`.
Camera lookAtCamera(glm::vec3 eye, glm::vec3 target, float yfovDegrees);

/// Direction from the camera through a pixel's centre.
glm::vec3 pixelDirection(const Camera& camera, int x, int y, int width, int height);

}  // namespace phat::test
