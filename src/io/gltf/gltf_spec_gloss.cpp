#include <fmt/format.h>
#include <stb_image_write.h>

#include <algorithm>
#include <cmath>

#include "io/gltf/gltf_container.h"
#include "io/gltf/gltf_json.h"
#include "io/gltf/gltf_picture.h"
#include "io/gltf/gltf_plain.h"

namespace phat::gltf {
namespace {

using nlohmann::json;

constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";

std::vector<uint8_t> pngOf(const TextureImage& image) {
    std::vector<uint8_t> bytes;
    const auto append = [](void* user, void* data, int size) {
        auto& all = *static_cast<std::vector<uint8_t>*>(user);
        all.insert(all.end(), static_cast<uint8_t*>(data), static_cast<uint8_t*>(data) + size);
    };
    if (!stbi_write_png_to_func(append, &bytes, image.width, image.height, 4, image.texels.data(),
                                4 * image.width))
        throw Problem("cannot be encoded again");
    return bytes;
}

// The image of a texture, as encoded; WebP and AVIF stand in extensions.
std::vector<uint8_t> imageBytes(const GltfSource& source, const json& texture, MemoryBudget& budget) {
    const json* from = &texture;
    for (const char* name : {"EXT_texture_webp", "EXT_texture_avif"})
        if (const json* extension = findExtension(texture, name)) from = extension;
    const json& image = gltfItem(source.json, "images", wholeNumber(*from, "source"));
    if (image.contains("uri")) {
        std::vector<uint8_t> bytes =
            readUri(image["uri"].get<std::string>(), gltfFolder(source), budget.left());
        budget.allowFor(bytes.size());
        return bytes;
    }
    const auto view = bufferViewBytes(source, wholeNumber(image, "bufferView"));
    return {view.begin(), view.end()};
}

// Alpha times the factor is the glossiness; G of a metallic-roughness texture is one minus that, B no metal.
json roughnessTexture(GltfSource& source, const json& info, double glossinessFactor, MemoryBudget& budget) {
    json texture = gltfItem(source.json, "textures", wholeNumber(info, "index"));
    TextureImage image = decodePicture(imageBytes(source, texture, budget), budget);
    for (glm::u8vec4& texel : image.texels) {
        const double glossiness = glossinessFactor * texel.a / 255.0;
        texel = {255, uint8_t(std::lround(255 * (1 - glossiness))), 0, 255};
    }
    // Encoded, a picture is no larger than its texels and some headers.
    budget.charge(image.texels.size() * 4 + 4096, "its converted materials");
    const size_t view = addBufferView(source, pngOf(image));
    budget.release(image.texels.size() * 4);
    source.json["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}});
    texture.erase("extensions");
    texture["source"] = source.json["images"].size() - 1;
    source.json["textures"].push_back(texture);
    json roughness = info;
    roughness["index"] = source.json["textures"].size() - 1;
    return roughness;
}

double factorOf(const json& extension, const char* key) {
    const double factor = extension.value(key, 1.0);
    return std::isfinite(factor) ? std::clamp(factor, 0.0, 1.0) : 1.0;
}

// Textures that materials share are converted once for each factor.
using Converted = std::map<std::string, json>;

void convert(GltfSource& source, json& material, Converted& converted, MemoryBudget& budget, Notes& notes) {
    const json extension = *findExtension(material, kSpecularGlossiness);
    const double glossiness = factorOf(extension, "glossinessFactor");
    json pbr = {{"metallicFactor", 0.0}, {"roughnessFactor", 1 - glossiness}};
    if (extension.contains("diffuseFactor")) pbr["baseColorFactor"] = extension["diffuseFactor"];
    if (extension.contains("diffuseTexture")) pbr["baseColorTexture"] = extension["diffuseTexture"];
    json specular = json::object();
    if (extension.contains("specularFactor")) specular["specularColorFactor"] = extension["specularFactor"];
    if (const auto info = extension.find("specularGlossinessTexture"); info != extension.end()) {
        specular["specularColorTexture"] = *info;  // RGB is what it was
        try {
            json& texture = converted[fmt::format("{} {}", info->dump(), glossiness)];
            if (texture.is_null()) texture = roughnessTexture(source, *info, glossiness, budget);
            pbr["metallicRoughnessTexture"] = texture;
            pbr["roughnessFactor"] = 1.0;
        } catch (const BudgetProblem&) {
            throw;
        } catch (const std::runtime_error& error) {
            notes.lines.push_back(fmt::format("a glossiness texture is left out: {}", error.what()));
        }
    }
    eraseExtension(material, kSpecularGlossiness);
    material["pbrMetallicRoughness"] = std::move(pbr);
    material["extensions"]["KHR_materials_specular"] = std::move(specular);
    // Full reflectance at normal incidence, which the specular colour scales: F0 is the specular colour.
    material["extensions"]["KHR_materials_ior"] = {{"ior", 0.0}};
}

}  // namespace

void convertSpecularGlossiness(GltfSource& source, MemoryBudget& budget, Notes& notes) {
    Converted converted;
    bool any = false;
    for (size_t i = 0; i < countOf(source.json, "materials"); ++i) {
        json material = gltfItem(source.json, "materials", i);
        if (!findExtension(material, kSpecularGlossiness)) continue;
        convert(source, material, converted, budget, notes);
        source.json["materials"][i] = std::move(material);
        any = true;
    }
    forgetExtension(source.json, kSpecularGlossiness);
    if (!any) return;
    useExtension(source.json, "KHR_materials_specular");
    useExtension(source.json, "KHR_materials_ior");
}

}  // namespace phat::gltf
