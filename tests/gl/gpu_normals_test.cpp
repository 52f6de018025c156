// Normal maps of what mirrors show.

#include <gtest/gtest.h>

#include "core/scene/shading.h"
#include "gl/traced_world.h"

namespace phat::test {
namespace {

// A ceiling whose picture turns its normal along the tangent and across, and lamps beside what the mirror
// shows of it.
TEST(GpuNormals, MirrorShowsNormalMaps) {
    Material mapped = lambert(0.5f);
    mapped.normalTexture.image = 0;
    mapped.normalScale = 0.8f;
    Scene scene = floorAndCeiling(whiteMetal(0), mapped);
    TextureImage image;
    image.width = image.height = 1;
    image.texels = {glm::u8vec4(204, 178, 230, 255)};
    scene.images.push_back(image);
    for (const float handedness : {1.0f, -1.0f}) {
        for (uint32_t v = scene.surfaces[1].firstVertex; v < scene.positions.size(); ++v)
            scene.tangents[v] = glm::vec4(glm::normalize(glm::vec3(1, 0, -0.5f)), handedness);
        const glm::vec3 seen(0.3f, 2, -2);
        for (const glm::vec3 way : {glm::vec3(0, -1, 0), glm::vec3(1, -1, 0), glm::vec3(0, -1, 1)}) {
            PunctualLight lamp;
            lamp.position = seen + way;
            lamp.intensity = glm::vec3(4);
            scene.lights = {lamp};
            const SurfacePoint point = surfaceAt(scene, scene.surfaces[1].firstTriangle, {0.3f, 0.3f}, false);
            const float cosine = glm::dot(point.shading.normal, glm::normalize(way));
            GpuWorld gpu(scene);
            gpu.frame.samplesPerPixel = 1;
            Renderer renderer(gpu.input(), kShaderFolder);
            EXPECT_NEAR(gpu.middle(renderer, Component::glossyIndirect),
                        0.5f / kPi * 4 * cosine / glm::dot(way, way), 0.01f)
                << handedness << way.x << way.z;
        }
    }
}

}  // namespace
}  // namespace phat::test
