#include "io/gltf/gltf_description.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>

namespace phat::gltf {
namespace {

using Json = nlohmann::json;

// tinygltf counts with int.
constexpr uint64_t kMaxIndex = 0x7fffffff;
constexpr uint64_t kMaxBytes = 1ull << 53;

// What a bake adds; its contents are checked where they are read.
constexpr const char* kBakedExtension = "PHAT_photon_accumulation_texture";

constexpr std::array kSupported = {
    "KHR_lights_punctual",   "KHR_materials_clearcoat", "KHR_materials_emissive_strength",
    "KHR_materials_ior",     "KHR_materials_specular",  "KHR_materials_transmission",
    "KHR_materials_unlit",   "KHR_materials_volume",    "KHR_mesh_quantization",
    "KHR_texture_transform", "EXT_texture_webp",        "EXT_texture_avif",
    "KHR_texture_basisu",    "KHR_materials_variants",  "KHR_node_visibility",
    "EXT_lights_ies",        kBakedExtension,
};

// Extensions that a file may require and that leave every surface where it is: it is drawn without them.
bool isDrawnWithout(const std::string& extension) {
    static constexpr std::array kNames = {
        "KHR_animation_pointer",  "KHR_node_hoverability",    "KHR_node_selectability",
        "KHR_interactivity",      "KHR_xmp_json_ld",          "KHR_audio_emitter",
        "EXT_lights_image_based", "KHR_physics_rigid_bodies", "KHR_implicit_shapes"};
    return extension.starts_with("KHR_materials_") || extension.starts_with("EXT_materials_") ||
           std::find(kNames.begin(), kNames.end(), extension) != kNames.end();
}

bool isSupported(const std::string& extension) {
    return std::find(kSupported.begin(), kSupported.end(), extension) != kSupported.end();
}

bool isOneOf(const std::string& key, std::initializer_list<const char*> keys) {
    return std::any_of(keys.begin(), keys.end(), [&](const char* k) { return key == k; });
}

void checkUnsigned(const std::string& key, const Json& value, uint64_t limit) {
    if (!value.is_number_unsigned() || value.get<uint64_t>() > limit) {
        throw Problem(fmt::format("\"{}\" is {}, not a number from 0 to {}", key,
                                  value.is_number() ? value.dump() : value.type_name(), limit));
    }
}

void checkNumbers(const std::string& key, const Json& value) {
    const bool good = value.is_array() &&
                      std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_number(); });
    if (!good) throw Problem(fmt::format("\"{}\" is not an array of numbers", key));
}

// tinygltf takes a mistyped optional property for a missing one and cuts large integers to 32 bits.
void checkProperty(const std::string& key, const Json& value) {
    if (isOneOf(key, {"mesh", "camera", "skin", "material", "bufferView", "buffer", "source", "sampler",
                      "index", "texCoord", "scene", "mode", "light", "skeleton", "componentType"})) {
        checkUnsigned(key, value, kMaxIndex);
    } else if (isOneOf(key, {"byteOffset", "byteLength", "byteStride", "count"})) {
        checkUnsigned(key, value, kMaxBytes);
    } else if (key == "indices" && !value.is_object()) {
        checkUnsigned(key, value, kMaxIndex);
    } else if (isOneOf(key, {"children", "joints"}) ||
               (key == "nodes" && value.is_array() && !value.empty() && !value.front().is_object())) {
        if (!value.is_array()) throw Problem(fmt::format("\"{}\" is not an array", key));
        for (const Json& element : value) checkUnsigned(key, element, kMaxIndex);
    } else if (isOneOf(key, {"matrix", "translation", "baseColorFactor", "emissiveFactor",
                             "specularColorFactor", "color", "weights"}) ||
               (isOneOf(key, {"rotation", "scale"}) && !value.is_number())) {
        checkNumbers(key, value);
    } else if (key == "attributes" && value.is_object()) {
        for (const auto& [name, accessor] : value.items()) checkUnsigned(name, accessor, kMaxIndex);
    }
}

// Removes extras and unknown extensions everywhere and gathers the latter's names.
void pruneAndCheck(Json& value, std::set<std::string>& unknown) {
    if (value.is_object()) {
        value.erase("extras");
        if (const auto extensions = value.find("extensions");
            extensions != value.end() && extensions->is_object()) {
            for (auto it = extensions->begin(); it != extensions->end();) {
                if (isSupported(it.key()) && it.key() != kBakedExtension) {
                    ++it;
                } else {
                    if (it.key() != kBakedExtension) unknown.insert(it.key());
                    it = extensions->erase(it);
                }
            }
        }
        for (auto& [key, child] : value.items()) {
            checkProperty(key, child);
            pruneAndCheck(child, unknown);
        }
    } else if (value.is_array()) {
        for (Json& child : value) pruneAndCheck(child, unknown);
    }
}

// The elements of a top-level array of objects.
const Json& section(const Json& root, const char* name) {
    static const Json kEmpty = Json::array();
    const auto it = root.find(name);
    if (it == root.end()) return kEmpty;
    if (!it->is_array()) throw Problem(fmt::format("\"{}\" is not an array", name));
    for (const Json& element : *it) {
        if (!element.is_object())
            throw Problem(fmt::format("\"{}\" holds something that is no object", name));
    }
    return *it;
}

std::string textOf(const Json& object, const char* key) {
    const auto it = object.find(key);
    if (it == object.end()) return {};
    if (!it->is_string()) throw Problem(fmt::format("\"{}\" is not a string", key));
    return it->get<std::string>();
}

std::vector<std::string> extensionList(const Json& root, const char* key) {
    std::vector<std::string> names;
    const auto it = root.find(key);
    if (it == root.end()) return names;
    if (!it->is_array()) throw Problem(fmt::format("\"{}\" is not an array", key));
    for (const Json& name : *it) {
        if (!name.is_string()) throw Problem(fmt::format("\"{}\" holds something that is no string", key));
        names.push_back(name.get<std::string>());
    }
    return names;
}

void checkVersion(const Json& root) {
    const auto asset = root.find("asset");
    if (asset == root.end() || !asset->is_object()) throw Problem("no \"asset\": not a glTF file");
    const std::string version = textOf(*asset, "version");
    if (!version.starts_with("2."))
        throw Problem(fmt::format("glTF version \"{}\" is not supported", version));
    const std::string least = textOf(*asset, "minVersion");
    if (!least.empty() && least != "2.0") throw Problem(fmt::format("needs glTF version \"{}\"", least));
}

std::vector<ImageEntry> takeImages(Json& root) {
    std::vector<ImageEntry> images;
    for (const Json& image : section(root, "images")) {
        ImageEntry entry{textOf(image, "name"), textOf(image, "uri"), -1};
        if (entry.uri.empty() && image.contains("bufferView"))
            entry.bufferView = image["bufferView"].get<int>();
        images.push_back(std::move(entry));
    }
    root.erase("images");
    return images;
}

int64_t indexOf(const Json& object, const char* key) {
    const auto it = object.find(key);
    return it != object.end() && it->is_number_integer() ? it->get<int64_t>() : -1;
}

// Every element of `channels` and `samplers` is looked at once, however often one is referred to.
std::vector<AnimationEntry> takeAnimations(Json& root, MemoryBudget& budget) {
    std::vector<AnimationEntry> animations;
    for (const Json& animation : section(root, "animations")) {
        const Json &samplers = section(animation, "samplers"), &channels = section(animation, "channels");
        budget.charge((channels.size() + 1) * (sizeof(ChannelEntry) + sizeof(AnimationEntry)),
                      "its animations");
        AnimationEntry entry{textOf(animation, "name"), {}};
        for (const Json& channel : channels) {
            const int64_t sampler = indexOf(channel, "sampler");
            const auto target = channel.find("target");
            if (target == channel.end() || !target->is_object() || sampler < 0 ||
                sampler >= int64_t(samplers.size()) || !samplers[size_t(sampler)].is_object()) {
                entry.channels.emplace_back();
                continue;
            }
            const Json& from = samplers[size_t(sampler)];
            entry.channels.push_back({indexOf(*target, "node"), indexOf(from, "input"),
                                      indexOf(from, "output"), textOf(*target, "path"),
                                      textOf(from, "interpolation")});
        }
        animations.push_back(std::move(entry));
    }
    root.erase("animations");
    return animations;
}

// tinygltf's structs are large ({} is a material of two kilobytes), so their number is charged first.
void chargeModel(const Json& root, MemoryBudget& budget) {
    constexpr uint64_t kGrowth = 3;  // a std::vector that grows holds old and new elements for a moment
    uint64_t bytes = 0;
    const auto add = [&](const char* name, size_t size) { bytes += section(root, name).size() * size; };
    add("accessors", sizeof(tinygltf::Accessor));
    add("bufferViews", sizeof(tinygltf::BufferView));
    add("cameras", sizeof(tinygltf::Camera));
    add("materials", sizeof(tinygltf::Material) + 512);  // and the maps that repeat its properties
    add("nodes", sizeof(tinygltf::Node));
    add("samplers", sizeof(tinygltf::Sampler));
    add("scenes", sizeof(tinygltf::Scene));
    add("textures", sizeof(tinygltf::Texture));
    for (const Json& mesh : section(root, "meshes")) {
        bytes += sizeof(tinygltf::Mesh) + section(mesh, "primitives").size() * sizeof(tinygltf::Primitive);
    }
    budget.charge(bytes * kGrowth, "the description of the scene");
}

}  // namespace

Description describe(const Json& json, MemoryBudget& budget, Notes& notes) {
    Json root = json;
    root.erase("buffers");  // they are read
    root.erase("skins");    // and applied
    checkVersion(root);
    for (const std::string& name : extensionList(root, "extensionsRequired")) {
        if (!isSupported(name) && !isDrawnWithout(name))
            throw Problem(fmt::format("it requires the extension {}, which is not supported", name));
    }

    std::vector<AnimationEntry> animations = takeAnimations(root, budget);
    std::set<std::string> unknown;
    for (const char* list : {"extensionsUsed", "extensionsRequired"})
        for (const std::string& name : extensionList(root, list))
            if (!isSupported(name)) unknown.insert(name);
    pruneAndCheck(root, unknown);
    for (const std::string& name : unknown) {
        notes.lines.push_back(fmt::format("the extension {} is not supported and is ignored", name));
    }

    Description description;
    description.animations = std::move(animations);
    description.images = takeImages(root);
    chargeModel(root, budget);

    const std::string pruned = root.dump(-1, ' ', false, Json::error_handler_t::replace);
    root = nullptr;
    tinygltf::TinyGLTF parser;
    std::string errors, warnings;
    bool parsed = false;
    try {
        parsed = parser.LoadASCIIFromString(&description.model, &errors, &warnings, pruned.data(),
                                            unsigned(pruned.size()), "");
    } catch (const std::exception& error) {
        errors = error.what();
    }
    if (!parsed || !errors.empty()) {
        throw Problem("invalid glTF: " + errors.substr(0, errors.find('\n')));
    }
    return description;
}

}  // namespace phat::gltf
