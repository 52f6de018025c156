#include "io/gltf/gltf_materials.h"

#include <fmt/core.h>

#include <cmath>

namespace phat::gltf {
namespace {

// Emission is squared and summed in floats; brighter lights than this lose to infinity.
constexpr double kMaxEmission = 1e12;
constexpr double kMaxIor = 100;
constexpr double kMinMeters = 1e-9, kMaxMeters = 1e9;

using Value = tinygltf::Value;

class Reader {
  public:
    Reader(const Document& document, Notes& notes) : document_(document), notes_(notes) {}

    Material material(size_t index);

  private:
    float clamped(double value, double low, double high) {
        const bool inside = value >= low && value <= high;
        if (!inside) ++notes_.clampedFactors;
        return float(inside ? value : value > high ? high : low);
    }
    float number(const Value& object, const char* key, double fallback, double low, double high) {
        const Value& value = object.Get(key);
        return value.IsNumber() ? clamped(value.GetNumberAsDouble(), low, high) : float(fallback);
    }
    glm::vec3 color(const Value& object, const char* key) {
        const Value& value = object.Get(key);
        if (value.ArrayLen() != 3) return glm::vec3(1);
        glm::vec3 rgb;
        for (int c = 0; c < 3; ++c) rgb[c] = clamped(value.Get(c).GetNumberAsDouble(), 0, kMaxEmission);
        return rgb;
    }
    template <typename Info>
    TextureSlot slot(const Info& info) {
        const auto transform = info.extensions.find("KHR_texture_transform");
        return slot(info.index, info.texCoord,
                    transform == info.extensions.end() ? Value() : transform->second);
    }
    TextureSlot slot(const Value& object, const char* key) {
        const Value& info = object.Get(key);
        if (!info.IsObject() || !info.Get("index").IsInt()) return {};
        const int texCoord = info.Get("texCoord").IsInt() ? info.Get("texCoord").GetNumberAsInt() : 0;
        const Value& extensions = info.Get("extensions");
        return slot(info.Get("index").GetNumberAsInt(), texCoord,
                    extensions.IsObject() ? extensions.Get("KHR_texture_transform") : Value());
    }
    TextureSlot slot(int texture, int texCoord, const Value& transform);
    int imageOf(int texture);
    glm::mat3x2 uvTransform(const Value& transform);
    void readExtensions(const tinygltf::ExtensionMap& extensions, Material& out);
    void readVolume(const Value& volume, Material& out);

    const Document& document_;
    Notes& notes_;
};

Wrap wrapOf(int mode) {
    if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::clampToEdge;
    if (mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Wrap::mirroredRepeat;
    return Wrap::repeat;
}

// KHR_texture_transform: translation * rotation * scale; rotation turns uv counter-clockwise as seen with v
// pointing down.
glm::mat3x2 Reader::uvTransform(const Value& transform) {
    if (!transform.IsObject()) return TextureSlot{}.uvTransform;
    const auto pair = [&](const char* key, float fallback) {
        const Value& value = transform.Get(key);
        if (value.ArrayLen() != 2) return glm::vec2(fallback);
        return glm::vec2(clamped(value.Get(0).GetNumberAsDouble(), -1e6, 1e6),
                         clamped(value.Get(1).GetNumberAsDouble(), -1e6, 1e6));
    };
    const glm::vec2 offset = pair("offset", 0), scale = pair("scale", 1);
    const float angle = number(transform, "rotation", 0, -1e6, 1e6);
    const float c = std::cos(angle), s = std::sin(angle);
    return {glm::vec2(c, -s) * scale.x, glm::vec2(s, c) * scale.y, offset};
}

// The image that is decoded: WebP before PNG and JPEG, and those before AVIF, which takes longest. What only
// KTX2 has cannot be drawn, and white in its place would be a lie.
int Reader::imageOf(int texture) {
    const auto& in = document_.model().textures[size_t(texture)];
    const auto sourceIn = [&](const char* name) {
        const auto found = in.extensions.find(name);
        if (found == in.extensions.end() || !found->second.Get("source").IsInt()) return -1;
        const int source = found->second.Get("source").GetNumberAsInt();
        if (source < 0 || size_t(source) >= document_.description.images.size())
            throw Problem(fmt::format("texture {}: no such image", texture));
        return source;
    };
    if (const int webp = sourceIn("EXT_texture_webp"); webp >= 0) return webp;
    if (in.source >= 0) return in.source;
    if (const int avif = sourceIn("EXT_texture_avif"); avif >= 0) return avif;
    if (sourceIn("KHR_texture_basisu") >= 0)
        throw Problem(
            fmt::format("texture {} \"{}\" is KTX2 (KHR_texture_basisu), which is not supported: "
                        "`npx @gltf-transform/cli ktxdecompress IN.glb OUT.glb` makes it PNG",
                        texture, in.name.substr(0, 60)));
    return -1;
}

TextureSlot Reader::slot(int texture, int texCoord, const Value& transform) {
    if (texture < 0) return {};
    const auto& model = document_.model();
    if (size_t(texture) >= model.textures.size())
        throw Problem(fmt::format("texture {} does not exist", texture));

    TextureSlot slot;
    slot.image = imageOf(texture);
    slot.uvSet = texCoord;
    if (transform.IsObject() && transform.Get("texCoord").IsInt()) {
        slot.uvSet = transform.Get("texCoord").GetNumberAsInt();
    }
    slot.uvTransform = uvTransform(transform);
    if (const int sampler = model.textures[size_t(texture)].sampler; sampler >= 0) {
        slot.wrapU = wrapOf(model.samplers[size_t(sampler)].wrapS);
        slot.wrapV = wrapOf(model.samplers[size_t(sampler)].wrapT);
        slot.nearest = model.samplers[size_t(sampler)].magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    if (slot.image < 0) {
        notes_.lines.push_back(fmt::format("texture {} has no picture and is ignored", texture));
        return {};
    }
    if (slot.uvSet > 1) {
        notes_.lines.push_back(
            fmt::format("texture {} uses TEXCOORD_{}, of which only 0 and 1 are supported: ignored", texture,
                        slot.uvSet));
        return {};
    }
    return slot;
}

void Reader::readExtensions(const tinygltf::ExtensionMap& extensions, Material& out) {
    const auto find = [&](const char* name) -> const Value* {
        const auto it = extensions.find(name);
        return it != extensions.end() && it->second.IsObject() ? &it->second : nullptr;
    };
    if (const Value* strength = find("KHR_materials_emissive_strength")) {
        out.emission *= number(*strength, "emissiveStrength", 1, 0, kMaxEmission);
    }
    if (const Value* ior = find("KHR_materials_ior")) {
        // 0 is legal and means full reflectance at normal incidence; anything else is at least 1.
        const Value& value = ior->Get("ior");
        const bool zero = value.IsNumber() && value.GetNumberAsDouble() == 0;
        out.ior = zero ? 0.0f : number(*ior, "ior", 1.5, 1, kMaxIor);
    }
    if (const Value* specular = find("KHR_materials_specular")) {
        out.specular = number(*specular, "specularFactor", 1, 0, 1);
        out.specularTexture = slot(*specular, "specularTexture");
        out.specularColor = color(*specular, "specularColorFactor");
        out.specularColorTexture = slot(*specular, "specularColorTexture");
    }
    if (const Value* coat = find("KHR_materials_clearcoat")) {
        out.clearcoat = number(*coat, "clearcoatFactor", 0, 0, 1);
        out.clearcoatTexture = slot(*coat, "clearcoatTexture");
        out.clearcoatRoughness = number(*coat, "clearcoatRoughnessFactor", 0, 0, 1);
        out.clearcoatRoughnessTexture = slot(*coat, "clearcoatRoughnessTexture");
        out.clearcoatNormalTexture = slot(*coat, "clearcoatNormalTexture");
        const Value& normal = coat->Get("clearcoatNormalTexture");
        if (normal.IsObject()) out.clearcoatNormalScale = number(normal, "scale", 1, -100, 100);
    }
    if (const Value* transmission = find("KHR_materials_transmission")) {
        out.transmission = number(*transmission, "transmissionFactor", 0, 0, 1);
        out.transmissionTexture = slot(*transmission, "transmissionTexture");
    }
    if (const Value* volume = find("KHR_materials_volume")) readVolume(*volume, out);
    if (extensions.count("KHR_materials_unlit") > 0) {
        out.unlit = true;
        out.emission = glm::vec3(out.baseColor);
        out.emissionTexture = out.baseColorTexture;
    }
}

void Reader::readVolume(const Value& volume, Material& out) {
    out.thickness = number(volume, "thicknessFactor", 0, 0, kMaxMeters);
    out.thicknessTexture = slot(volume, "thicknessTexture");
    out.attenuationColor = glm::min(color(volume, "attenuationColor"), glm::vec3(1));
    // Infinity where there is none; 0, which is not allowed, would be opaque.
    if (volume.Get("attenuationDistance").IsNumber())
        out.attenuationDistance = number(volume, "attenuationDistance", 1, kMinMeters, kMaxMeters);
}

Material Reader::material(size_t index) {
    const tinygltf::Material& in = document_.model().materials[index];
    const auto& pbr = in.pbrMetallicRoughness;
    Material out;
    out.name = in.name.empty() ? fmt::format("material {}", index) : in.name;
    for (int c = 0; c < 4; ++c) out.baseColor[c] = clamped(pbr.baseColorFactor[size_t(c)], 0, 1);
    out.baseColorTexture = slot(pbr.baseColorTexture);
    out.metallic = clamped(pbr.metallicFactor, 0, 1);
    out.roughness = clamped(pbr.roughnessFactor, 0, 1);
    out.metallicRoughnessTexture = slot(pbr.metallicRoughnessTexture);
    out.normalScale = clamped(in.normalTexture.scale, -100, 100);
    out.normalTexture = slot(in.normalTexture);
    for (int c = 0; c < 3; ++c) out.emission[c] = clamped(in.emissiveFactor[size_t(c)], 0, kMaxEmission);
    out.emissionTexture = slot(in.emissiveTexture);
    out.doubleSided = in.doubleSided;
    if (in.alphaMode == "MASK") out.alphaMode = AlphaMode::mask;
    if (in.alphaMode == "BLEND") out.alphaMode = AlphaMode::blend;
    out.alphaCutoff = clamped(in.alphaCutoff, 0, kMaxEmission);
    readExtensions(in.extensions, out);
    out.emission = glm::min(out.emission, glm::vec3(float(kMaxEmission)));
    // Pictures that nothing can show are not worth decoding.
    if (out.emission == glm::vec3(0)) out.emissionTexture = {};
    if (out.clearcoat == 0) {
        out.clearcoatTexture = out.clearcoatRoughnessTexture = out.clearcoatNormalTexture = {};
    }
    if (out.transmission == 0) out.transmissionTexture = {};
    if (out.thickness == 0) out.thicknessTexture = {};
    return out;
}

}  // namespace

std::vector<Material> readMaterials(const Document& document, Notes& notes) {
    Reader reader(document, notes);
    std::vector<Material> materials;
    for (size_t i = 0; i < document.model().materials.size(); ++i) materials.push_back(reader.material(i));
    return materials;
}

Material defaultMaterial() {
    Material material;
    material.name = "default";
    return material;
}

}  // namespace phat::gltf
