#pragma once
// Worlds of quads whose lobes can be traced.

#include "core/bvh/scene_bvh.h"
#include "core/render/traced_reflections.h"
#include "core/scene/lights.h"
#include "gl/renderer_world.h"

namespace phat::test {

/// That reflects all light.
Material whiteMetal(float roughness);

/// A floor (surface 0) under a ceiling (surface 1) two metres above.
Scene floorAndCeiling(const Material& floor, const Material& ceiling, float size = 8);

/// The upper half of the sky toward -Z, and the rest of the directions.
Environment skyOfHalves(float ahead, float elsewhere);

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

/// A world whose floor is seen by rays of the GPU, from a metre above; the lookup of the floor says 2.
struct GpuWorld {
    explicit GpuWorld(Scene scene)
        : world(worldOfQuads(std::move(scene), 4)), bvh(buildSceneBvh(world.scene)) {
        fillWithLookups(world, 2, 0);
        frame.width = 32;
        frame.height = 24;
        frame.camera = lookAtCamera({0, 1, 1}, {0.1f, 0, 0}, 2);
        frame.samplesPerPixel = 4;
        frame.tracedByGpu = Reflections::rays;
    }

    RendererInput input() const { return {world.scene, world.atlas, world.points, world.phatexture, &bvh}; }
    /// The mean of what the pixels show, all of them near one point of the floor.
    float middle(Renderer& renderer, Component component) {
        frame.component = component;
        const Image image = renderer.render(frame);
        double sum = 0;
        for (const glm::vec3& pixel : image.pixels) sum += double(pixel.x);
        return float(sum / double(image.pixels.size()));
    }

    HeadlessContext context;
    RendererWorld world;
    SceneBvh bvh;
    FrameSettings frame;
};

}  // namespace phat::test
