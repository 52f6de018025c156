#include "gl/hit_tables.h"

#include <algorithm>
#include <bit>
#include <glm/gtc/packing.hpp>

#include "core/base/math.h"
#include "core/base/octahedral.h"
#include "core/scene/light_emitters.h"
#include "core/scene/transparency.h"
#include "gl/alias_table.h"
#include "gl/atlas_sides.h"
#include "gl/textures.h"

namespace phat {
namespace {

constexpr uint32_t kMaterialTexels = 5, kTriangleTexels = 6, kEmitterTexels = 4;
constexpr uint32_t kMaxTangent = 2046;  // twin: mappedNormal in shaders/lib/hit_surface.glsl
constexpr uint32_t kUnlit = 1, kDoubleSided = 2, kReadsColors = 4, kMirroredU = 16, kClampedU = 32,
                   kMirroredV = 64, kClampedV = 128;

// Of a triangle, beside its material's number.
constexpr uint32_t kHitGlass = 0x80000000u, kHitVolume = 0x40000000u;

uint32_t bitsOf(float x) {
    return std::bit_cast<uint32_t>(x);
}

glm::uvec4 bitsOf(glm::vec3 v, float w) {
    return {bitsOf(v.x), bitsOf(v.y), bitsOf(v.z), bitsOf(w)};
}

glm::uvec4 bitsOf(glm::vec2 a, glm::vec2 b) {
    return {bitsOf(a.x), bitsOf(a.y), bitsOf(b.x), bitsOf(b.y)};
}

bool samePlace(const TextureSlot& a, const TextureSlot& b) {
    return a.uvSet == b.uvSet && a.wrapU == b.wrapU && a.wrapV == b.wrapV && a.uvTransform == b.uvTransform;
}

// The slot whose texture coordinates a triangle has; those of a material's other pictures that lie elsewhere
// are replaced by their means.
const TextureSlot& placedSlot(const Material& m) {
    for (const TextureSlot* slot :
         {&m.baseColorTexture, &m.emissionTexture, &m.metallicRoughnessTexture, &m.normalTexture})
        if (slot->image >= 0) return *slot;
    return m.baseColorTexture;
}

uint32_t layerOf(const TextureSlot& slot, const TextureSlot& placed,
                 const std::map<int32_t, uint32_t>& layers) {
    const auto found = samePlace(slot, placed) ? layers.find(slot.image) : layers.end();
    return found == layers.end() ? kNoLayer : found->second;
}

uint32_t wrapFlags(const TextureSlot& slot) {
    const auto flag = [](Wrap wrap, uint32_t mirrored, uint32_t clamped) {
        return wrap == Wrap::mirroredRepeat ? mirrored : wrap == Wrap::clampToEdge ? clamped : 0;
    };
    return flag(slot.wrapU, kMirroredU, kClampedU) | flag(slot.wrapV, kMirroredV, kClampedV);
}

bool anyColored(const Scene& scene) {
    return std::any_of(scene.colors.begin(), scene.colors.end(),
                       [](glm::vec4 c) { return glm::vec3(c) != glm::vec3(1); });
}

// 1/m: Beer's law.
glm::vec3 absorptionOf(const Material& m) {
    return -glm::log(glm::max(m.attenuationColor, glm::vec3(1e-6f))) / m.attenuationDistance;
}

void addMaterial(std::vector<glm::uvec4>& texels, const Scene& scene, const Material& m,
                 const HitImages& images, bool colored) {
    const TextureSlot& placed = placedSlot(m);
    const uint32_t color = layerOf(m.baseColorTexture, placed, images.colorLayers);
    const uint32_t emission = layerOf(m.emissionTexture, placed, images.colorLayers);
    const uint32_t roughness = layerOf(m.metallicRoughnessTexture, placed, images.linearLayers);
    const uint32_t normal = layerOf(m.normalTexture, placed, images.linearLayers);
    const auto mean = [&](const TextureSlot& slot, bool srgb) { return meanTexel(scene, slot, srgb); };
    glm::vec3 baseColor(m.baseColor), emitted(m.emission);
    glm::vec2 metallicRoughness(m.metallic, m.roughness);
    if (color == kNoLayer) baseColor *= glm::vec3(mean(m.baseColorTexture, true));
    if (emission == kNoLayer) emitted *= glm::vec3(mean(m.emissionTexture, true));
    if (roughness == kNoLayer) {
        const glm::vec4 texel = mean(m.metallicRoughnessTexture, false);
        metallicRoughness *= glm::vec2(texel.b, texel.g);
    }
    // KHR_materials_specular and KHR_materials_ior.
    const float specular = m.specular * mean(m.specularTexture, false).a;
    const glm::vec3 tint = m.specularColor * glm::vec3(mean(m.specularColorTexture, true));
    const glm::vec3 f0 = specular * glm::min(square((m.ior - 1) / (m.ior + 1)) * tint, glm::vec3(1));
    const float f90 = specular * std::min(maxComponent(f0) / 0.02f, 1.0f);
    const float transmission = isGlass(m) ? m.transmission * mean(m.transmissionTexture, false).r : 0.0f;
    const bool shines = m.emission != glm::vec3(0);
    const uint32_t flags = (m.unlit ? kUnlit : 0) | (m.doubleSided ? kDoubleSided : 0) |
                           (colored || shines ? kReadsColors : 0) | wrapFlags(placed);
    texels.push_back(bitsOf(baseColor, metallicRoughness.x));
    texels.push_back(bitsOf(emitted, metallicRoughness.y));
    texels.push_back(bitsOf(f0, f90));
    texels.push_back({glm::packHalf2x16({m.clearcoat * mean(m.clearcoatTexture, false).r,
                                         m.clearcoatRoughness * mean(m.clearcoatRoughnessTexture, false).g}),
                      glm::packHalf2x16({transmission, m.normalScale}), flags,
                      color | emission << 8 | roughness << 16 | normal << 24});
    texels.push_back(bitsOf(absorptionOf(m), m.ior));
}

// Lengths of texture coordinates over those of the surface, 1/m.
float uvPerMeter(const std::array<glm::vec3, 3>& corners, const std::array<glm::vec2, 3>& uvs) {
    const float area = glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    const glm::vec2 a = uvs[1] - uvs[0], b = uvs[2] - uvs[0];
    return area > 0 ? std::sqrt(std::abs(a.x * b.y - a.y * b.x) / area) : 0.0f;
}

uint32_t packColor(glm::vec4 color) {
    const glm::uvec3 bytes(glm::clamp(glm::vec3(color), 0.0f, 1.0f) * 255.0f + 0.5f);
    return bytes.x | bytes.y << 8 | bytes.z << 16;
}

// 24 bits: octahedral, the handedness plus 2. `tangent`: the sum of the corners'; 0 where they have none.
uint32_t packTangent(glm::vec4 tangent) {
    const glm::vec3 along(tangent);
    if (glm::length(along) < 1e-6f) return 0;
    const glm::vec2 square = 0.5f * octahedralFromDirection(glm::normalize(along)) + 0.5f;
    const glm::uvec2 code(glm::clamp(square, 0.0f, 1.0f) * float(kMaxTangent) + 0.5f);
    return code.x | code.y << 11 | (tangent.w < 0 ? 1u : 3u) << 22;
}

// Metres, of a pane.
float thicknessOf(const Scene& scene, const Surface& surface) {
    const Material& m = scene.materials[surface.material];
    return m.thickness * surface.metersPerUnit * meanTexel(scene, m.thicknessTexture, false).g;
}

void addTriangle(std::vector<glm::uvec4>& texels, const Scene& scene, const Atlas& atlas, uint32_t triangle,
                 uint32_t emitter, Glass glass) {
    const Surface& surface = scene.surfaces[scene.triangleSurface[triangle]];
    const TextureSlot& slot = placedSlot(scene.materials[surface.material]);
    const auto& uvSet = slot.uvSet == 0 ? scene.uv0 : scene.uv1;
    const AtlasSides sides = atlasSidesOf(atlas, triangle);
    std::array<glm::vec2, 3> texel, uvs;
    std::array<glm::vec3, 3> corners;
    const uint32_t kind = glass == Glass::none     ? 0
                          : glass == Glass::volume ? kHitGlass | kHitVolume
                                                   : kHitGlass;
    const float thickness = glass == Glass::thin ? thicknessOf(scene, surface) : 0.0f;
    glm::uvec4 normals(0, 0, 0, surface.material | kind), colors(0, 0, 0, emitter);
    glm::vec4 tangent(0);
    for (int i = 0; i < 3; ++i) {
        const uint32_t v = scene.triangles[triangle][i];
        texel[size_t(i)] = atlas.triangleTexels[triangle][i] + sides.frontOffset;
        uvs[size_t(i)] = slot.uvTransform * glm::vec3(uvSet[v], 1.0f);
        corners[size_t(i)] = scene.positions[v];
        normals[i] = glm::packSnorm2x16(octahedralFromDirection(scene.normals[v]));
        colors[i] = packColor(scene.colors[v]);
        tangent += scene.tangents[v];
    }
    for (int i = 0; i < 3; ++i) colors[i] |= (packTangent(tangent) >> (8 * i)) << 24;
    const glm::ivec2 toBack(sides.backOffset - sides.frontOffset);
    texels.push_back(bitsOf(texel[0], texel[1]));
    texels.push_back({bitsOf(texel[2].x), bitsOf(texel[2].y), sides.charts.x, sides.charts.y});
    texels.push_back(normals);
    texels.push_back(bitsOf(uvs[0], uvs[1]));
    texels.push_back(
        {bitsOf(uvs[2].x), bitsOf(uvs[2].y), uint32_t(toBack.x & 0xffff) | uint32_t(toBack.y) << 16,
         glm::packHalf2x16({std::min(uvPerMeter(corners, uvs), 6e4f), std::min(thickness, 6e4f)})});
    texels.push_back(colors);
}

void addEmitters(std::vector<glm::uvec4>& texels, const Scene& scene,
                 const std::vector<EmissiveTriangle>& emitters) {
    double sum = 0;
    std::vector<double> chances;
    for (const EmissiveTriangle& emitter : emitters) sum += chances.emplace_back(luminance(emitter.power()));
    for (double& chance : chances) chance /= sum;
    const AliasTable table = aliasTable(chances);
    for (size_t i = 0; i < emitters.size(); ++i) {
        const EmissiveTriangle& emitter = emitters[i];
        const glm::uvec3 t = scene.triangles[emitter.triangle];
        const float areaDensity = float(chances[i]) / emitter.areaSquareMeters;
        texels.push_back(bitsOf(scene.positions[t.x], table.threshold[i]));
        texels.push_back({glm::uvec3(bitsOf(scene.positions[t.y], 0)), table.alias[i]});
        texels.push_back(bitsOf(scene.positions[t.z], 0));
        texels.push_back(bitsOf(emitter.radiance, emitter.doubleSided ? -areaDensity : areaDensity));
    }
}

std::vector<EmissiveTriangle> shiningTriangles(const Scene& scene) {
    std::vector<EmissiveTriangle> emitters = findEmissiveTriangles(scene);
    std::erase_if(emitters, [](const EmissiveTriangle& e) { return !(luminance(e.power()) > 0); });
    return emitters;
}

}  // namespace

GpuHits uploadHits(const Scene& scene, const Atlas& atlas, const SceneBvh& bvh) {
    GpuHits gpu;
    gpu.images = uploadHitImages(scene);
    gpu.filtered = createSampler(GL_CLAMP_TO_EDGE, GL_CLAMP_TO_EDGE, GL_LINEAR, GL_LINEAR);
    updateHits(gpu, scene, atlas, bvh);
    return gpu;
}

void updateHits(GpuHits& gpu, const Scene& scene, const Atlas& atlas, const SceneBvh& bvh) {
    const std::vector<EmissiveTriangle> emitters = shiningTriangles(scene);
    std::vector<uint32_t> emitterOf(scene.triangles.size(), 0);
    for (uint32_t i = 0; i < emitters.size(); ++i) emitterOf[emitters[i].triangle] = i + 1;
    std::vector<glm::uvec4> texels;
    texels.reserve(kMaterialTexels * scene.materials.size() + kTriangleTexels * bvh.order.size() +
                   kEmitterTexels * emitters.size());
    const bool colored = anyColored(scene);
    for (const Material& material : scene.materials)
        addMaterial(texels, scene, material, gpu.images, colored);
    gpu.firstTriangle = uint32_t(texels.size());
    const std::vector<Glass> glass = glassOfSurfaces(scene, scene.materials);
    for (const uint32_t triangle : bvh.order)
        addTriangle(texels, scene, atlas, triangle, emitterOf[triangle],
                    glass.empty() ? Glass::none : glass[scene.triangleSurface[triangle]]);
    gpu.firstEmitter = uint32_t(texels.size());
    gpu.emitterCount = int(emitters.size());
    addEmitters(texels, scene, emitters);
    gpu.table = createTable(std::span<const glm::uvec4>(texels));
    checkGl("uploading what rays hit");
}

void bindHits(const GpuHits& gpu, const ShaderProgram& program, int firstUnit) {
    program.set("hitFirstTriangle", int(gpu.firstTriangle));
    program.set("hitFirstEmitter", int(gpu.firstEmitter));
    program.set("emitterCount", gpu.emitterCount);
    program.bind("hitTable", firstUnit, gpu.table.name());
    program.bind("hitColors", firstUnit + 1, gpu.images.colors.name());
    program.bind("hitLinear", firstUnit + 2, gpu.images.linear.name());
}

}  // namespace phat
