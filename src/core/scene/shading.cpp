#include "core/scene/shading.h"

#include <array>

#include "core/base/srgb.h"
#include "core/scene/footprint.h"
#include "core/scene/transparency.h"

namespace phat {
namespace {

std::array<float, 256> makeSrgbTable() {
    std::array<float, 256> table{};
    for (int i = 0; i < 256; ++i) table[i] = linearFromSrgb(float(i) / 255.0f);
    return table;
}

glm::vec4 decodeTexel(glm::u8vec4 texel, bool srgb) {
    static const std::array<float, 256> table = makeSrgbTable();
    const glm::vec4 linear = glm::vec4(texel) / 255.0f;
    if (!srgb) return linear;
    return {table[texel.r], table[texel.g], table[texel.b], linear.a};
}

int wrapTexel(int i, int size, Wrap wrap) {
    if (wrap == Wrap::clampToEdge) return std::clamp(i, 0, size - 1);
    const int period = wrap == Wrap::mirroredRepeat ? 2 * size : size;
    int m = i % period;
    if (m < 0) m += period;
    return m < size ? m : period - 1 - m;
}

// Brings a coordinate near the picture before it is scaled to texels, so that no integer overflows.
float wrapCoordinate(float u, Wrap wrap) {
    if (!std::isfinite(u)) return 0.0f;
    return wrap == Wrap::clampToEdge ? std::clamp(u, -1.0f, 2.0f) : u - 2.0f * std::floor(0.5f * u);
}

/// Attributes of a triangle interpolated at a point of it.
struct Interpolated {
    glm::vec3 position, normalGeometric, normal;
    glm::vec4 tangent, color;
    glm::vec2 uv[2];
    const TextureLevels* levels = nullptr;  // with a footprint, whose sides in uv follow: [set][side]
    glm::vec2 uvSides[2][2];
};

template <typename T>
T interpolate(const std::vector<T>& values, glm::uvec3 t, glm::vec2 b) {
    return values[t.x] * (1.0f - b.x - b.y) + values[t.y] * b.x + values[t.z] * b.y;
}

glm::vec2 clampToTriangle(glm::vec2 b) {
    b = glm::max(b, glm::vec2(0));
    const float sum = b.x + b.y;
    return sum > 1.0f ? b / sum : b;
}

Interpolated interpolateAt(const Scene& scene, uint32_t triangle, glm::vec2 barycentric) {
    const glm::uvec3 t = scene.triangles[triangle];
    const glm::vec2 inside = clampToTriangle(barycentric);
    Interpolated at;
    at.position = interpolate(scene.positions, t, barycentric);
    const glm::vec3 cross =
        glm::cross(scene.positions[t.y] - scene.positions[t.x], scene.positions[t.z] - scene.positions[t.x]);
    const float area2 = glm::length(cross);
    const glm::vec3 normal = interpolate(scene.normals, t, inside);
    const float length = glm::length(normal);
    at.normalGeometric = area2 > 0.0f ? cross / area2 : glm::vec3(0, 1, 0);
    at.normal = length > 1e-6f ? normal / length : at.normalGeometric;
    at.tangent = interpolate(scene.tangents, t, inside);
    at.color = interpolate(scene.colors, t, inside);
    at.uv[0] = interpolate(scene.uv0, t, inside);
    at.uv[1] = interpolate(scene.uv1, t, inside);
    return at;
}

glm::vec4 lookUp(const Scene& scene, const TextureSlot& slot, const Interpolated& at, bool srgb) {
    if (slot.image < 0) return glm::vec4(1);
    if (at.levels)
        return sampleTexture(scene, slot, at.uv[slot.uvSet], srgb, *at.levels, at.uvSides[slot.uvSet]);
    return sampleTexture(scene, slot, at.uv[slot.uvSet], srgb);
}

void addFootprint(const Scene& scene, uint32_t triangle, const Footprint& footprint, Interpolated& at) {
    const glm::uvec3 t = scene.triangles[triangle];
    const glm::vec3 ab = scene.positions[t.y] - scene.positions[t.x];
    const glm::vec3 ac = scene.positions[t.z] - scene.positions[t.x];
    // The barycentric coordinates' slopes: the dual basis of the two edges.
    const float b2 = glm::dot(ab, ab), c2 = glm::dot(ac, ac), bc = glm::dot(ab, ac);
    const float determinant = b2 * c2 - bc * bc;
    if (!(determinant > 0)) return;
    const glm::vec3 slopeB = (c2 * ab - bc * ac) / determinant, slopeC = (b2 * ac - bc * ab) / determinant;
    at.levels = &footprint.levels;
    for (int set = 0; set < 2; ++set) {
        const std::vector<glm::vec2>& uv = set == 0 ? scene.uv0 : scene.uv1;
        for (int side = 0; side < 2; ++side)
            at.uvSides[set][side] = glm::dot(slopeB, footprint.sides[side]) * (uv[t.y] - uv[t.x]) +
                                    glm::dot(slopeC, footprint.sides[side]) * (uv[t.z] - uv[t.x]);
    }
}

glm::vec3 normalFromMap(const Scene& scene, const TextureSlot& slot, float scale, const Interpolated& at) {
    const glm::vec3 n = glm::vec3(lookUp(scene, slot, at, false)) * 2.0f - 1.0f;
    const glm::vec3 tangent(at.tangent);
    const glm::vec3 bitangent = at.tangent.w * glm::cross(at.normal, tangent);
    const glm::vec3 mapped = n.x * scale * tangent + n.y * scale * bitangent + n.z * at.normal;
    const float length = glm::length(mapped);
    return length > 1e-6f ? mapped / length : at.normal;
}

bool hasTangent(const Interpolated& at) {
    return glm::dot(glm::vec3(at.tangent), glm::vec3(at.tangent)) > 1e-8f;
}

Brdf brdfAt(const Scene& scene, const Material& m, const Interpolated& at) {
    Brdf brdf;
    const glm::vec3 base = glm::clamp(
        glm::vec3(m.baseColor * at.color * lookUp(scene, m.baseColorTexture, at, true)), 0.0f, 1.0f);
    const glm::vec4 metallicRoughness = lookUp(scene, m.metallicRoughnessTexture, at, false);
    const float metallic = std::clamp(m.metallic * metallicRoughness.b, 0.0f, 1.0f);
    const float roughness = std::clamp(m.roughness * metallicRoughness.g, 0.0f, 1.0f);
    const float specular = m.specular * lookUp(scene, m.specularTexture, at, false).a;
    const glm::vec3 specularColor =
        m.specularColor * glm::vec3(lookUp(scene, m.specularColorTexture, at, true));

    // KHR_materials_specular and KHR_materials_ior.
    const glm::vec3 dielectricF0 =
        specular * glm::min(square((m.ior - 1.0f) / (m.ior + 1.0f)) * specularColor, glm::vec3(1));
    // A surface that reflects nothing at normal incidence has no interface and reflects nothing at grazing
    // either; glTF leaves F90 = specular there. Real dielectrics have F0 >= .02.
    const float dielectricF90 = specular * std::min(maxComponent(dielectricF0) / 0.02f, 1.0f);

    brdf.diffuseColor =
        base * (1.0f - metallic) * (1.0f - meanFresnel(maxComponent(dielectricF0), dielectricF90));
    if (isGlass(m)) {
        brdf.transmission =
            std::clamp(m.transmission * lookUp(scene, m.transmissionTexture, at, false).r, 0.0f, 1.0f);
        brdf.diffuseColor *= 1.0f - brdf.transmission;
        brdf.transmissionColor = brdf.transmission * (1.0f - metallic) * base;
    }
    brdf.f0 = glm::mix(dielectricF0, base, metallic);
    brdf.f90 = glm::mix(dielectricF90, 1.0f, metallic);
    brdf.alpha = std::max(roughness * roughness, kMinAlpha);
    brdf.clearcoat = std::clamp(m.clearcoat * lookUp(scene, m.clearcoatTexture, at, false).r, 0.0f, 1.0f);
    if (brdf.clearcoat > 0.0f) {
        const float coatRoughness = std::clamp(
            m.clearcoatRoughness * lookUp(scene, m.clearcoatRoughnessTexture, at, false).g, 0.0f, 1.0f);
        brdf.clearcoatAlpha = std::max(coatRoughness * coatRoughness, kMinAlpha);
    }
    return brdf;
}

enum class Backs : uint8_t { asTheMaterialSays, asFronts };

SurfacePoint shade(const Scene& scene, uint32_t triangle, const Interpolated& at, bool back, Backs backs) {
    const Material& material = scene.materialOf(triangle);
    const float side = back ? -1.0f : 1.0f;

    SurfacePoint point;
    point.position = at.position;
    point.normalGeometric = side * at.normalGeometric;
    point.triangle = triangle;
    point.backFace = back;

    glm::vec3 normal = at.normal;
    if (material.normalTexture.image >= 0 && hasTangent(at))
        normal = normalFromMap(scene, material.normalTexture, material.normalScale, at);
    point.shading = frameFromNormalAndTangent(side * normal, glm::vec3(at.tangent));

    if (back && !material.doubleSided && backs == Backs::asTheMaterialSays) {
        point.brdf = {.diffuseColor = glm::vec3(0), .f0 = glm::vec3(0), .f90 = 0};
        return point;
    }
    point.emission = material.emission * glm::vec3(lookUp(scene, material.emissionTexture, at, true));
    if (material.unlit) {
        point.emission *= glm::vec3(at.color);
        point.brdf = {.diffuseColor = glm::vec3(0), .f0 = glm::vec3(0), .f90 = 0};
        return point;
    }
    point.brdf = brdfAt(scene, material, at);
    if (point.brdf.clearcoat > 0.0f) {
        const bool mapped = material.clearcoatNormalTexture.image >= 0 && hasTangent(at);
        const glm::vec3 coat =
            mapped ? normalFromMap(scene, material.clearcoatNormalTexture, material.clearcoatNormalScale, at)
                   : at.normal;
        point.brdf.clearcoatNormal = point.shading.toLocal(side * coat);
    }
    return point;
}

SurfacePoint shade(const Scene& scene, uint32_t triangle, glm::vec2 barycentric, bool back,
                   Backs backs = Backs::asTheMaterialSays) {
    return shade(scene, triangle, interpolateAt(scene, triangle, barycentric), back, backs);
}

glm::vec4 sampleImage(const TextureImage& image, const TextureSlot& slot, glm::vec2 moved, bool srgb) {
    if (image.texels.empty()) return glm::vec4(1);
    const glm::vec2 texel =
        glm::vec2(wrapCoordinate(moved.x, slot.wrapU), wrapCoordinate(moved.y, slot.wrapV)) *
        glm::vec2(image.width, image.height);

    const auto fetch = [&](int x, int y) {
        x = wrapTexel(x, image.width, slot.wrapU);
        y = wrapTexel(y, image.height, slot.wrapV);
        return decodeTexel(image.texels[size_t(y) * image.width + x], srgb);
    };
    if (slot.nearest) return fetch(int(std::floor(texel.x)), int(std::floor(texel.y)));

    const glm::vec2 corner = texel - 0.5f;
    const glm::vec2 floor = glm::floor(corner);
    const glm::vec2 t = corner - floor;
    const int x = int(floor.x), y = int(floor.y);
    return glm::mix(glm::mix(fetch(x, y), fetch(x + 1, y), t.x),
                    glm::mix(fetch(x, y + 1), fetch(x + 1, y + 1), t.x), t.y);
}

}  // namespace

glm::vec4 sampleTexture(const Scene& scene, const TextureSlot& slot, glm::vec2 uv, bool srgb) {
    if (slot.image < 0) return glm::vec4(1);
    return sampleImage(scene.images[slot.image], slot, slot.uvTransform * glm::vec3(uv, 1.0f), srgb);
}

glm::vec4 sampleTexture(const Scene& scene, const TextureSlot& slot, glm::vec2 uv, bool srgb,
                        const TextureLevels& levels, const glm::vec2 (&sides)[2]) {
    if (slot.image < 0) return glm::vec4(1);
    const TextureImage& image = scene.images[slot.image];
    const glm::vec2 size(image.width, image.height);
    const glm::vec2 moved = slot.uvTransform * glm::vec3(uv, 1.0f);
    glm::vec2 along = slot.uvTransform * glm::vec3(sides[0], 0.0f);
    glm::vec2 across = slot.uvTransform * glm::vec3(sides[1], 0.0f);
    float longer = glm::length(along * size), shorter = glm::length(across * size);
    if (longer < shorter) {
        std::swap(longer, shorter);
        std::swap(along, across);
    }
    if (!(longer > 1.0f) || !std::isfinite(longer)) return sampleImage(image, slot, moved, srgb);

    const int samples =
        int(std::clamp(std::ceil(longer / std::max(shorter, 1.0f)), 1.0f, float(kMaxFootprintSamples)));
    const float level = std::log2(std::max({longer / float(samples), shorter, 1.0f}));
    const int finer = int(level);
    const TextureImage& fine = levels.at(scene, slot.image, srgb, finer);
    const TextureImage& coarse = levels.at(scene, slot.image, srgb, finer + 1);
    glm::vec4 sum(0);
    for (int i = 0; i < samples; ++i) {
        const glm::vec2 at = moved + along * ((float(i) + 0.5f) / float(samples) - 0.5f);
        sum += glm::mix(sampleImage(fine, slot, at, srgb), sampleImage(coarse, slot, at, srgb),
                        level - float(finer));
    }
    return sum / float(samples);
}

namespace {

SurfacePoint facing(SurfacePoint point, glm::vec3 direction) {
    // Interpolated normals may face away from the viewer at silhouettes; bend them back just over the edge.
    constexpr float kMinCosine = 1e-3f;
    const float cosine = -glm::dot(point.shading.normal, direction);
    if (cosine < kMinCosine) {
        const glm::vec3 bent = glm::normalize(point.shading.normal - (kMinCosine - cosine) * direction);
        point.shading = frameFromNormalAndTangent(bent, point.shading.tangent);
    }
    return point;
}

}  // namespace

SurfacePoint surfaceAt(const Scene& scene, const Hit& hit, glm::vec3 direction) {
    return facing(shade(scene, hit.triangle, hit.barycentric, hit.backFace), direction);
}

SurfacePoint surfaceAt(const Scene& scene, const Hit& hit, glm::vec3 direction, const Footprint& footprint) {
    Interpolated at = interpolateAt(scene, hit.triangle, hit.barycentric);
    addFootprint(scene, hit.triangle, footprint, at);
    return facing(shade(scene, hit.triangle, at, hit.backFace, Backs::asTheMaterialSays), direction);
}

SurfacePoint glassAt(const Scene& scene, const Hit& hit, glm::vec3 direction) {
    return facing(shade(scene, hit.triangle, hit.barycentric, hit.backFace, Backs::asFronts), direction);
}

float thicknessAt(const Scene& scene, const Hit& hit) {
    const Material& m = scene.materialOf(hit.triangle);
    const float meters = m.thickness * scene.surfaces[scene.triangleSurface[hit.triangle]].metersPerUnit;
    if (m.thicknessTexture.image < 0) return meters;
    const Interpolated at = interpolateAt(scene, hit.triangle, hit.barycentric);
    return meters * lookUp(scene, m.thicknessTexture, at, false).g;
}

SurfacePoint surfaceAt(const Scene& scene, uint32_t triangle, glm::vec2 barycentric, bool back) {
    return shade(scene, triangle, barycentric, back);
}

glm::vec3 positionAt(const Scene& scene, uint32_t triangle, glm::vec2 barycentric) {
    return interpolate(scene.positions, scene.triangles[triangle], barycentric);
}

float opacityAt(const Scene& scene, uint32_t triangle, glm::vec2 barycentric) {
    const Material& material = scene.materialOf(triangle);
    if (material.alphaMode == AlphaMode::opaque) return 1.0f;
    const glm::uvec3 t = scene.triangles[triangle];
    float alpha = material.baseColor.a * interpolate(scene.colors, t, barycentric).a;
    const TextureSlot& slot = material.baseColorTexture;
    if (slot.image >= 0) {
        const glm::vec2 uv = interpolate(slot.uvSet == 0 ? scene.uv0 : scene.uv1, t, barycentric);
        alpha *= sampleTexture(scene, slot, uv, true).a;
    }
    if (material.alphaMode == AlphaMode::mask) return alpha < material.alphaCutoff ? 0.0f : 1.0f;
    return std::clamp(alpha, 0.0f, 1.0f);
}

}  // namespace phat
