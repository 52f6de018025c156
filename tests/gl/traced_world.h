#pragma once
// Worlds of quads whose lobes can be traced.

#include "core/render/traced_reflections.h"
#include "core/scene/lights.h"
#include "gl/renderer_world.h"

namespace phat::test {

/// That reflects all light.
Material whiteMetal(float roughness);

/// A floor (surface 0) under a ceiling (surface 1) two metres above.
Scene floorAndCeiling(const Material& floor, const Material& ceiling, float size = 8);

/// A mirror under two panels of radiance 1 (x < 0) and 9.
Scene mirrorUnderTwoPanels();
/// Of its picture: the border between the panels is mirrored where geometry says, to the pixel.
void expectMirroredBorder(const Image& image, const Camera& camera);

/// Of all texels of a surface's chart.
void setIrradiance(RendererWorld& world, uint32_t surface, float wattsPerSquareMeter);

/// With wrong PHATexels, of one radiance everywhere: lookups show nothing of the scene.
void fillWithLookups(RendererWorld& world, float indirect, float area);

/// What rays read of a world.
struct WorldOfRays {
    explicit WorldOfRays(const RendererWorld& world)
        : rays(world.scene),
          lights(world.scene),
          scene(rays, lights, world.atlas, world.points, world.phatexture) {}

    RayScene rays;
    LightSampler lights;
    ReflectionScene scene;
};

}  // namespace phat::test
