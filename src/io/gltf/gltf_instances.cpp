#include <fmt/format.h>

#include "io/gltf/gltf_json.h"
#include "io/gltf/gltf_plain.h"

namespace phat::gltf {
namespace {

using nlohmann::json;

constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";

// One number group of every instance, by its name in a node.
struct Channel {
    const char* key;
    uint32_t components;
    std::vector<float> values;
};

// source: EXT_mesh_gpu_instancing, "Extending nodes": the instance's transform is T * R * S below the node's.
std::vector<Channel> channelsOf(const GltfSource& source, const json& attributes, MemoryBudget& budget) {
    std::vector<Channel> channels;
    std::optional<uint64_t> count;
    const auto read = [&](const char* attribute, const char* key, uint32_t components) {
        if (!attributes.contains(attribute)) return;
        const uint64_t accessor = wholeNumber(attributes, attribute);
        const uint64_t elements = wholeNumber(gltfItem(source.json, "accessors", accessor), "count");
        if (count && *count != elements) throw Problem("its instances' attributes differ in count");
        // A node of the file, a node of the scene and their surfaces, at least.
        constexpr uint64_t kInstanceBytes = 1024;
        if (!count && elements > budget.left() / kInstanceBytes) budget.charge(~0ull, "its instances");
        if (!count) budget.charge(elements * kInstanceBytes, "its instances");
        count = elements;
        channels.push_back(
            {key, components, accessorFloats(source, accessor, components, components == 4, elements)});
    };
    read("TRANSLATION", "translation", 3);
    read("ROTATION", "rotation", 4);
    read("SCALE", "scale", 3);
    return channels;
}

}  // namespace

void expandInstances(GltfSource& source, MemoryBudget& budget) {
    const size_t fileNodes = countOf(source.json, "nodes");
    for (size_t n = 0; n < fileNodes; ++n) {
        const json node = gltfItem(source.json, "nodes", n);
        const json* instancing = findExtension(node, kInstancing);
        if (!instancing) continue;
        if (node.contains("mesh") && instancing->contains("attributes")) {
            const std::vector<Channel> channels = channelsOf(source, instancing->at("attributes"), budget);
            const size_t count = channels.empty() ? 0 : channels[0].values.size() / channels[0].components;
            json& nodes = source.json["nodes"];
            for (size_t i = 0; i < count; ++i) {
                json instance = {{"mesh", node["mesh"]}};
                for (const char* key : {"name", "weights"})
                    if (node.contains(key)) instance[key] = node[key];
                for (const Channel& channel : channels)
                    for (uint32_t c = 0; c < channel.components; ++c)
                        instance[channel.key].push_back(channel.values[i * channel.components + c]);
                nodes[n]["children"].push_back(nodes.size());
                nodes.push_back(std::move(instance));
            }
            for (const char* key : {"mesh", "skin", "weights"}) nodes[n].erase(key);
        }
        eraseExtension(source.json["nodes"][n], kInstancing);
    }
    forgetExtension(source.json, kInstancing);
}

}  // namespace phat::gltf
