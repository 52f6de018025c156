#include "peer_picture.h"

#include <algorithm>
#include <stdexcept>

namespace phat::peers {

uint32_t materialNamed(const Scene& scene, const std::string& name) {
    const auto found = std::find_if(scene.materials.begin(), scene.materials.end(),
                                    [&](const Material& material) { return material.name == name; });
    if (found == scene.materials.end()) throw std::invalid_argument("there is no material " + name);
    return uint32_t(found - scene.materials.begin());
}

Integrator peerIntegrator(const RayScene& rays, const Scene& materials, uint32_t material, Shade shade) {
    splitSumTable();  // integrated now, rather than on the clock of the first sample
    return [&rays, &materials, material, shade = std::move(shade)](const Ray& ray, PixelSample& sample) {
        const Hit hit = visibleHit(rays, ray, sample.rays);
        if (!hit || materialAt(materials, hit.triangle) != material) return glm::vec3(0);
        return shade(hit, surfaceAt(materials, hit, ray.direction), -ray.direction);
    };
}

Image materialMask(const RayScene& rays, uint32_t material, const Camera& camera, int width, int height) {
    constexpr glm::vec2 kPoints[] = {{0.5f, 0.5f}, {0, 0}, {1, 0}, {0, 1}, {1, 1}};
    Image mask(width, height);
    uint64_t rayCount = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const bool all = std::all_of(std::begin(kPoints), std::end(kPoints), [&](glm::vec2 position) {
                const Hit hit =
                    visibleHit(rays, cameraRay(camera, width, height, glm::vec2(x, y) + position), rayCount);
                return hit && materialAt(rays.scene(), hit.triangle) == material;
            });
            if (all) mask.at(x, y) = glm::vec3(1);
        }
    }
    return mask;
}

void keepWindow(Image& mask, int left, int top, int width, int height) {
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x)
            if (x < left || y < top || x >= left + width || y >= top + height) mask.at(x, y) = glm::vec3(0);
}

Image thinned(const Image& mask, size_t count) {
    std::vector<size_t> kept;
    for (size_t i = 0; i < mask.pixels.size(); ++i)
        if (mask.pixels[i].x > 0.5f) kept.push_back(i);
    std::sort(kept.begin(), kept.end(), [](size_t a, size_t b) { return hashOf(a) < hashOf(b); });
    kept.resize(std::min(count, kept.size()));
    Image thin(mask.width, mask.height);
    for (const size_t i : kept) thin.pixels[i] = glm::vec3(1);
    return thin;
}

}  // namespace phat::peers
