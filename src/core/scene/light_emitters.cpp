#include "core/scene/light_emitters.h"

#include <tbb/parallel_for.h>

namespace phat {
namespace {

// Texture samples a triangle: two a texel that it covers, within these bounds. The mean only steers the
// choice of emitters and the reported power; photons and samples carry the radiance of their own position.
constexpr uint32_t kMinSamples = 16, kMaxSamples = 1024;
// Triangles that look black are scanned texel by texel up to this many, and taken to emit beyond.
constexpr float kMaxScannedTexels = 4096;
// Estimate, as a fraction of untextured emission, for those that are not scanned. ours: small enough not to
// draw samples from visible emitters.
constexpr float kUnknownEmission = 1e-3f;

struct UvBox {
    glm::vec2 low, high;  // in texels of the emission texture
    float areaTexels;     // texels under the triangle, by area
};

UvBox emissionTexels(const Scene& scene, const Material& material, uint32_t triangle) {
    const TextureSlot& slot = material.emissionTexture;
    const std::vector<glm::vec2>& uv = slot.uvSet == 1 ? scene.uv1 : scene.uv0;
    const TextureImage& image = scene.images[slot.image];
    glm::vec2 corner[3];
    for (int i = 0; i < 3; ++i) {
        const uint32_t vertex = scene.triangles[triangle][i];
        corner[i] = slot.uvTransform * glm::vec3(vertex < uv.size() ? uv[vertex] : glm::vec2(0), 1.0f);
        corner[i] *= glm::vec2(image.width, image.height);
    }
    const glm::vec2 a = corner[1] - corner[0], b = corner[2] - corner[0];
    return {glm::min(corner[0], glm::min(corner[1], corner[2])),
            glm::max(corner[0], glm::max(corner[1], corner[2])), 0.5f * std::abs(a.x * b.y - a.y * b.x)};
}

// Whether any texel that a lookup on the triangle may read is brighter than black.
bool anyTexelShines(const Scene& scene, const Material& material, const UvBox& box) {
    // Half a texel more on either side: the support of bilinear interpolation.
    const glm::vec2 low = glm::floor(box.low - 0.5f), high = glm::floor(box.high + 0.5f);
    const glm::vec2 count = high - low + 1.0f;
    if (!(count.x * count.y <= kMaxScannedTexels)) return true;
    TextureSlot slot = material.emissionTexture;
    slot.uvTransform = glm::mat3x2(1, 0, 0, 1, 0, 0);
    slot.nearest = true;
    const TextureImage& image = scene.images[slot.image];
    for (int y = 0; y < int(count.y); ++y) {
        for (int x = 0; x < int(count.x); ++x) {
            const glm::vec2 uv = (low + glm::vec2(x, y) + 0.5f) / glm::vec2(image.width, image.height);
            if (maxComponent(glm::vec3(sampleTexture(scene, slot, uv, true))) > 0) return true;
        }
    }
    return false;
}

bool oneColor(const Scene& scene, const Surface& surface) {
    const auto first = scene.colors.begin() + surface.firstVertex;
    return std::all_of(first, first + surface.vertexCount, [&](glm::vec4 color) { return color == *first; });
}

bool emissionIsUniform(const Scene& scene, const Surface& surface) {
    const Material& material = scene.materials[surface.material];
    const bool opaque = material.alphaMode == AlphaMode::opaque;
    return material.emissionTexture.image < 0 && (opaque || material.baseColorTexture.image < 0) &&
           ((opaque && !material.unlit) || oneColor(scene, surface));
}

glm::vec3 meanRadiance(const Scene& scene, const Material& material, const EmissiveTriangle& emitter) {
    if (emitter.uniform) return emittedRadiance(scene, emitter, glm::vec2(1.0f / 3.0f));
    const bool textured = material.emissionTexture.image >= 0;
    UvBox box{};
    uint32_t count = kMinSamples;
    if (textured) {
        box = emissionTexels(scene, material, emitter.triangle);
        count = uint32_t(std::clamp(2.0f * box.areaTexels, float(kMinSamples), float(kMaxSamples)));
    }
    glm::dvec3 sum(0);
    for (uint32_t i = 0; i < count; ++i) {
        // Additive recurrence of the plastic number. source: Roberts 2018, "R2".
        const glm::dvec2 square =
            glm::fract(glm::dvec2(0.5) + double(i) * glm::dvec2(0.7548776662466927, 0.5698402909980532));
        sum += glm::dvec3(emittedRadiance(scene, emitter, squareToTriangle(glm::vec2(square))));
    }
    if (maxComponent(glm::vec3(sum)) > 0) return glm::vec3(sum / double(count));
    if (textured && !anyTexelShines(scene, material, box)) return glm::vec3(0);
    return kUnknownEmission * material.emission;
}

}  // namespace

glm::vec2 squareToTriangle(glm::vec2 square) {
    return square.y > square.x ? glm::vec2(0.5f * square.x, square.y - 0.5f * square.x)
                               : glm::vec2(square.x - 0.5f * square.y, 0.5f * square.y);
}

glm::vec3 pointOnTriangle(const Scene& scene, uint32_t triangle, glm::vec2 barycentric) {
    const glm::uvec3 corner = scene.triangles[triangle];
    const glm::vec3 origin = scene.positions[corner.x];
    return origin + barycentric.x * (scene.positions[corner.y] - origin) +
           barycentric.y * (scene.positions[corner.z] - origin);
}

glm::vec3 emittedRadiance(const Scene& scene, const EmissiveTriangle& emitter, glm::vec2 barycentric) {
    return surfaceAt(scene, emitter.triangle, barycentric, false).emission *
           opacityAt(scene, emitter.triangle, barycentric);
}

std::vector<EmissiveTriangle> findEmissiveTriangles(const Scene& scene) {
    std::vector<EmissiveTriangle> found;
    for (const Surface& surface : scene.surfaces) {
        const Material& material = scene.materials[surface.material];
        if (!(maxComponent(material.emission) > 0)) continue;
        const bool uniform = emissionIsUniform(scene, surface);
        for (uint32_t i = 0; i < surface.triangleCount; ++i) {
            const uint32_t triangle = surface.firstTriangle + i;
            const glm::uvec3 corner = scene.triangles[triangle];
            const glm::vec3 across = glm::cross(scene.positions[corner.y] - scene.positions[corner.x],
                                                scene.positions[corner.z] - scene.positions[corner.x]);
            const float length = glm::length(across);
            if (!(length > 0)) continue;
            found.push_back(
                {triangle, 0.5f * length, across / length, glm::vec3(0), uniform, material.doubleSided});
        }
    }
    tbb::parallel_for(size_t(0), found.size(), [&](size_t i) {
        found[i].radiance = meanRadiance(scene, scene.materialOf(found[i].triangle), found[i]);
    });
    std::erase_if(found,
                  [](const EmissiveTriangle& emitter) { return !(maxComponent(emitter.radiance) > 0); });
    return found;
}

}  // namespace phat
