#include "io/gltf/gltf_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "io/gltf/gltf_accessor.h"
#include "io/gltf/gltf_problem.h"

namespace phat::gltf {

using nlohmann::json;

const json* findExtension(const json& object, const char* name) {
    const auto extensions = object.find("extensions");
    if (extensions == object.end() || !extensions->is_object()) return nullptr;
    const auto found = extensions->find(name);
    return found == extensions->end() || !found->is_object() ? nullptr : &*found;
}

void eraseExtension(json& object, const char* name) {
    const auto extensions = object.find("extensions");
    if (extensions == object.end() || !extensions->is_object()) return;
    extensions->erase(name);
    if (extensions->empty()) object.erase(extensions);
}

void forgetExtension(json& gltf, const char* name) {
    for (const char* array : {"extensionsUsed", "extensionsRequired"}) {
        const auto names = gltf.find(array);
        if (names == gltf.end() || !names->is_array()) continue;
        names->erase(std::remove(names->begin(), names->end(), json(name)), names->end());
        if (names->empty()) gltf.erase(names);
    }
}

void useExtension(json& gltf, const char* name) {
    json& used = gltf["extensionsUsed"];
    if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
}

size_t countOf(const json& gltf, const char* array) {
    const auto found = gltf.find(array);
    return found == gltf.end() || !found->is_array() ? 0 : found->size();
}

std::vector<int64_t> parentNodes(const json& gltf) {
    std::vector<int64_t> parents(countOf(gltf, "nodes"), -1);
    for (size_t i = 0; i < parents.size(); ++i) {
        const json& node = gltfItem(gltf, "nodes", i);
        if (!node.contains("children")) continue;
        for (const json& child : node["children"])
            if (child.get<uint64_t>() < parents.size()) parents[child.get<uint64_t>()] = int64_t(i);
    }
    return parents;
}

std::vector<uint64_t> sceneNodes(const json& gltf, bool withHidden) {
    std::vector<uint64_t> nodes;
    std::vector<bool> seen(countOf(gltf, "nodes"), false);
    const auto visit = [&](const json& index) {
        const uint64_t node = index.get<uint64_t>();
        const json* visibility = findExtension(gltfItem(gltf, "nodes", node), "KHR_node_visibility");
        const bool hidden = visibility && visibility->value("visible", json(true)) == json(false);
        if (seen[node] || (hidden && !withHidden)) return;
        seen[node] = true;
        nodes.push_back(node);
    };
    if (countOf(gltf, "scenes") > 0) {
        const json& scene = gltfItem(gltf, "scenes", wholeNumber(gltf, "scene", 0));
        if (scene.contains("nodes"))
            for (const json& node : scene["nodes"]) visit(node);
    } else {
        const std::vector<int64_t> parents = parentNodes(gltf);
        for (size_t i = 0; i < parents.size(); ++i)
            if (parents[i] < 0) visit(json(i));
    }
    for (size_t next = 0; next < nodes.size(); ++next) {
        const json& node = gltf["nodes"][nodes[next]];
        if (node.contains("children"))
            for (const json& child : node["children"]) visit(child);
    }
    return nodes;
}

namespace {

bool isReadable(const GltfSource& source, const json& sampler) {
    try {
        for (const char* key : {"input", "output"}) {
            const uint64_t accessor = wholeNumber(sampler, key);
            // Without data it is zeros.
            if (gltfItem(source.json, "accessors", accessor).contains("bufferView"))
                readAccessor(source, accessor);
        }
        return true;
    } catch (const std::exception&) {
        return false;
    }
}

// The sampler of a channel that moves a node, or no node at all; none where it is malformed.
std::optional<uint64_t> samplerOf(const GltfSource& source, const json& channel) {
    try {
        const json& target = channel.at("target");
        if (target.contains("node")) gltfItem(source.json, "nodes", wholeNumber(target, "node"));
        return wholeNumber(channel, "sampler");
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

}  // namespace

size_t dropBrokenChannels(const GltfSource& source, json& animation) {
    std::map<uint64_t, size_t> newSampler;
    json samplers = json::array(), channels = json::array();
    for (size_t i = 0; i < countOf(animation, "samplers"); ++i) {
        if (!isReadable(source, animation["samplers"][i])) continue;
        newSampler[i] = samplers.size();
        samplers.push_back(animation["samplers"][i]);
    }
    const size_t count = countOf(animation, "channels");
    for (size_t i = 0; i < count; ++i) {
        json& channel = animation["channels"][i];
        const auto sampler = samplerOf(source, channel);
        if (!sampler || !newSampler.contains(*sampler)) continue;
        channel["sampler"] = newSampler[*sampler];
        channels.push_back(channel);
    }
    animation["samplers"] = std::move(samplers);
    animation["channels"] = std::move(channels);
    return count - animation["channels"].size();
}

size_t addBufferView(GltfSource& source, std::vector<uint8_t> bytes, uint32_t byteStride) {
    json view = {{"buffer", source.buffers.size()}, {"byteLength", bytes.size()}};
    if (byteStride != 0) view["byteStride"] = byteStride;
    source.buffers.push_back(std::move(bytes));
    json& views = source.json["bufferViews"];
    views.push_back(std::move(view));
    return views.size() - 1;
}

namespace {

template <typename T>
std::vector<uint8_t> bytesOf(std::span<const T> values) {
    const auto* first = reinterpret_cast<const uint8_t*>(values.data());
    return {first, first + values.size_bytes()};
}

}  // namespace

size_t addAccessor(GltfSource& source, json accessor, std::vector<uint8_t> bytes, uint32_t byteStride) {
    accessor["bufferView"] = addBufferView(source, std::move(bytes), byteStride);
    json& accessors = source.json["accessors"];
    accessors.push_back(std::move(accessor));
    return accessors.size() - 1;
}

size_t addFloats(GltfSource& source, const std::vector<float>& values, uint32_t components) {
    const std::string type = components == 1 ? "SCALAR" : fmt::format("VEC{}", components);
    return addAccessor(source,
                       {{"componentType", kFloat}, {"type", type}, {"count", values.size() / components}},
                       bytesOf<float>(values));
}

size_t addIndices(GltfSource& source, std::span<const uint32_t> indices) {
    return addAccessor(source,
                       {{"componentType", kUnsignedInt}, {"type", "SCALAR"}, {"count", indices.size()}},
                       bytesOf(indices));
}

std::vector<size_t> giveNodesTheirOwnMeshes(json& gltf, std::span<const Surface> surfaces) {
    std::map<uint64_t, size_t> users;
    for (const json& node : gltf.value("nodes", json::array()))
        if (node.contains("mesh")) ++users[wholeNumber(node, "mesh")];
    std::map<uint32_t, size_t> meshOfNode;
    std::vector<size_t> meshOfSurface;
    for (const Surface& surface : surfaces) {
        const auto [found, isNew] = meshOfNode.try_emplace(surface.node, surface.mesh);
        if (isNew && users[surface.mesh]-- > 1) {
            const json copy = gltfItem(gltf, "meshes", surface.mesh);
            found->second = gltf["meshes"].size();
            gltf["meshes"].push_back(copy);
            gltf["nodes"].at(surface.node)["mesh"] = found->second;
        }
        meshOfSurface.push_back(found->second);
    }
    return meshOfSurface;
}

std::vector<float> accessorFloats(const GltfSource& source, uint64_t index, uint32_t components,
                                  bool asNormalized, std::optional<uint64_t> expectedCount) {
    const AccessorElements elements = readAccessor(source, index, expectedCount);
    if (elements.components != components)
        throw Problem(fmt::format("accessor {} has not {} components", index, components));
    const bool normalized =
        asNormalized || gltfItem(source.json, "accessors", index).value("normalized", false);
    std::vector<float> floats(elements.count * components);
    const size_t size = elements.elementSize / components;
    for (size_t i = 0; i < floats.size(); ++i)
        floats[i] = componentOf(&elements.bytes[i * size], int(elements.componentType), normalized);
    return floats;
}

}  // namespace phat::gltf
