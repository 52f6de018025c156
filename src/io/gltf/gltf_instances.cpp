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

struct Instances {
    uint64_t count = 0;
    std::vector<Channel> channels;
};

// source: EXT_mesh_gpu_instancing, "Extending nodes": the instance's transform is T * R * S below the node's.
// Attributes of the application's own count instances too.
Instances instancesOf(const GltfSource& source, const json& attributes, MemoryBudget& budget) {
    Instances instances;
    bool isFirst = true;
    for (const auto& [name, accessor] : attributes.items()) {
        const uint64_t index = wholeNumber(attributes, name.c_str());
        const uint64_t count = wholeNumber(gltfItem(source.json, "accessors", index), "count");
        // A node of the file, a node of the scene and their surfaces, at least.
        constexpr uint64_t kInstanceBytes = 1024;
        if (isFirst) budget.charge(count > budget.left() ? count : count * kInstanceBytes, "its instances");
        if (!isFirst && instances.count != count) throw Problem("its instances' attributes differ in count");
        isFirst = false;
        instances.count = count;
        const char* key = name == "TRANSLATION" ? "translation"
                          : name == "ROTATION"  ? "rotation"
                          : name == "SCALE"     ? "scale"
                                                : nullptr;
        if (!key) continue;
        const uint32_t components = name == "ROTATION" ? 4 : 3;
        instances.channels.push_back(
            {key, components, accessorFloats(source, index, components, components == 4, count)});
    }
    return instances;
}

}  // namespace

void expandInstances(GltfSource& source, MemoryBudget& budget) {
    const size_t fileNodes = countOf(source.json, "nodes");
    for (size_t n = 0; n < fileNodes; ++n) {
        const json node = gltfItem(source.json, "nodes", n);
        const json* instancing = findExtension(node, kInstancing);
        if (!instancing) continue;
        if (node.contains("mesh") && instancing->contains("attributes")) {
            const Instances instances = instancesOf(source, instancing->at("attributes"), budget);
            json& nodes = source.json["nodes"];
            for (size_t i = 0; i < instances.count; ++i) {
                json instance = {{"mesh", node["mesh"]}};
                for (const char* key : {"name", "weights"})
                    if (node.contains(key)) instance[key] = node[key];
                for (const Channel& channel : instances.channels)
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
