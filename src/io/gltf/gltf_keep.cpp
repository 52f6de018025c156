#include "io/gltf/gltf_keep.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "io/gltf/gltf_json.h"
#include "io/gltf/gltf_light_profiles.h"
#include "io/gltf/gltf_picture.h"
#include "io/gltf/gltf_rewrite.h"

namespace phat {
namespace {

using nlohmann::json;

size_t keepView(const GltfSource& source, uint64_t index, GlbBuilder& glb, Kept& kept) {
    const auto [found, isNew] = kept.views.try_emplace(index, 0);
    if (!isNew) return found->second;
    const json& old = gltfItem(source.json, "bufferViews", index);
    found->second = appendBufferView(glb, bufferViewBytes(source, index));
    json& view = glb.json["bufferViews"].back();
    for (const char* key : {"byteStride", "target", "name", "extras"})
        if (old.contains(key)) view[key] = old[key];
    return found->second;
}

size_t keepAccessor(const GltfSource& source, uint64_t index, GlbBuilder& glb, Kept& kept) {
    const auto [found, isNew] = kept.accessors.try_emplace(index, 0);
    if (!isNew) return found->second;
    json accessor = gltfItem(source.json, "accessors", index);
    const auto remapView = [&](json& object) {
        if (object.contains("bufferView"))
            object["bufferView"] = keepView(source, wholeNumber(object, "bufferView"), glb, kept);
    };
    remapView(accessor);
    if (accessor.contains("sparse")) {
        remapView(accessor["sparse"]["indices"]);
        remapView(accessor["sparse"]["values"]);
    }
    json& accessors = glb.json["accessors"];
    accessors.push_back(std::move(accessor));
    return found->second = accessors.size() - 1;
}

// Whether the extension holds no index of an accessor or a bufferView.
bool holdsNoBufferReference(const std::string& extension) {
    static constexpr std::array kKnown = {
        kPhatExtension,          "KHR_lights_punctual", gltf::kLightProfiles, "KHR_texture_transform",
        "KHR_mesh_quantization", "KHR_texture_basisu",  "EXT_texture_webp",   "EXT_texture_avif",
        "KHR_xmp_json_ld",       "KHR_node_visibility"};
    return extension.starts_with("KHR_materials_") ||
           std::find(kKnown.begin(), kKnown.end(), extension) != kKnown.end();
}

void keepPrimitive(const GltfSource& source, json& primitive, GlbBuilder& glb, Kept& kept) {
    const auto remapAll = [&](json& attributes) {
        for (auto& [name, index] : attributes.items())
            index = keepAccessor(source, index.get<uint64_t>(), glb, kept);
    };
    remapAll(primitive.at("attributes"));
    if (primitive.contains("targets"))
        for (json& target : primitive["targets"]) remapAll(target);
    if (primitive.contains("indices"))
        primitive["indices"] = keepAccessor(source, wholeNumber(primitive, "indices"), glb, kept);
}

// 1x1 white: what a lookup in a missing picture gives.
constexpr uint8_t kWhitePng[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
    0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00, 0x00, 0x3a, 0x7e, 0x9b, 0x55, 0x00,
    0x00, 0x00, 0x0a, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0xf8, 0x0f, 0x00, 0x01, 0x01, 0x01, 0x00,
    0x1b, 0xb6, 0xee, 0x56, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

void embedImage(const GltfSource& source, json& image, GlbBuilder& glb, std::vector<std::string>& notes) {
    std::vector<uint8_t> bytes;
    try {
        bytes = readGltfUri(source, image["uri"].get<std::string>());
    } catch (const std::exception& error) {
        notes.push_back(fmt::format("an image is replaced by white: {}", error.what()));
    }
    const std::string_view mimeType = gltf::pictureType(bytes);
    if (mimeType.empty()) bytes.assign(std::begin(kWhitePng), std::end(kWhitePng));
    image.erase("uri");
    image["mimeType"] = mimeType.empty() ? "image/png" : mimeType;
    image["bufferView"] = appendBufferView(glb, bytes);
}

// Photometric files beside the source are embedded, too. One that cannot be read was noted when it was
// loaded.
void keepLightProfiles(const GltfSource& source, GlbBuilder& glb, Kept& kept) {
    if (!gltf::findExtension(glb.json, gltf::kLightProfiles)) return;
    json profiles = glb.json["extensions"][gltf::kLightProfiles].value("lights", json::array());
    for (json& profile : profiles) {
        if (!profile.is_object()) continue;
        try {
            if (profile.contains("uri"))
                profile["bufferView"] =
                    appendBufferView(glb, readGltfUri(source, profile["uri"].get<std::string>()));
            else
                profile["bufferView"] = keepView(source, wholeNumber(profile, "bufferView"), glb, kept);
            profile.erase("uri");
            profile["mimeType"] = "application/x-ies-lm-63";
        } catch (const std::exception&) {
            profile.erase("bufferView");
        }
    }
    glb.json["extensions"][gltf::kLightProfiles]["lights"] = std::move(profiles);
}

}  // namespace

void keepAllIfReferencesAreUnknown(const GltfSource& source, GlbBuilder& glb, Kept& kept) {
    const json used = source.json.value("extensionsUsed", json::array());
    if (std::all_of(used.begin(), used.end(), [](const json& name) { return holdsNoBufferReference(name); }))
        return;
    for (size_t i = 0; i < source.json.value("bufferViews", json::array()).size(); ++i)
        keepView(source, i, glb, kept);
    for (size_t i = 0; i < source.json.value("accessors", json::array()).size(); ++i)
        keepAccessor(source, i, glb, kept);
}

void keepReferences(const GltfSource& source, const std::set<std::pair<size_t, size_t>>& rewrittenPrimitives,
                    GlbBuilder& glb, Kept& kept, std::vector<std::string>& notes) {
    const auto each = [&](const char* array, auto&& visit) {
        if (!glb.json.contains(array)) return;
        json items = std::move(glb.json[array]);  // visits append to other parts of glb.json
        for (size_t i = 0; i < items.size(); ++i) visit(items[i], i);
        glb.json[array] = std::move(items);
    };
    const auto remap = [&](json& object, const char* key) {
        if (object.contains(key)) object[key] = keepAccessor(source, wholeNumber(object, key), glb, kept);
    };
    each("meshes", [&](json& mesh, size_t m) {
        if (!mesh.contains("primitives")) return;
        for (size_t p = 0; p < mesh.at("primitives").size(); ++p)
            if (!rewrittenPrimitives.contains({m, p}))
                keepPrimitive(source, mesh["primitives"][p], glb, kept);
    });
    each("animations", [&](json& animation, size_t) {
        for (json& sampler : animation.at("samplers")) {
            remap(sampler, "input");
            remap(sampler, "output");
        }
    });
    each("skins", [&](json& skin, size_t) { remap(skin, "inverseBindMatrices"); });
    keepLightProfiles(source, glb, kept);
    each("images", [&](json& image, size_t) {
        if (image.contains("uri")) return embedImage(source, image, glb, notes);
        if (image.contains("bufferView"))
            image["bufferView"] = keepView(source, wholeNumber(image, "bufferView"), glb, kept);
    });
}

}  // namespace phat
