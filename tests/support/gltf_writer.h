#pragma once
// Scenes made in the tests as files.

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "core/scene/scene.h"

namespace phat::test {

/// Writes positions, triangles and plain materials of a scene as NAME.gltf, with the buffer beside it.
inline void writeGltf(const std::string& path, const Scene& scene) {
    using nlohmann::json;
    std::vector<char> bytes;
    json gltf = {{"asset", {{"version", "2.0"}}},
                 {"scene", 0},
                 {"scenes", {{{"nodes", {0}}}}},
                 {"nodes", {{{"mesh", 0}}}}};
    const auto view = [&](const void* data, size_t size) {
        gltf["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", size}});
        bytes.resize(bytes.size() + size);
        std::memcpy(bytes.data() + bytes.size() - size, data, size);
        return gltf["bufferViews"].size() - 1;
    };
    for (const Surface& surface : scene.surfaces) {
        const Material& material = scene.materials[surface.material];
        const glm::vec3* first = &scene.positions[surface.firstVertex];
        glm::vec3 low(1e30f), high(-1e30f);
        for (uint32_t i = 0; i < surface.vertexCount; ++i) {
            low = glm::min(low, first[i]);
            high = glm::max(high, first[i]);
        }
        std::vector<uint32_t> indices;
        for (uint32_t t = 0; t < surface.triangleCount; ++t)
            for (int c = 0; c < 3; ++c)
                indices.push_back(scene.triangles[surface.firstTriangle + t][c] - surface.firstVertex);
        gltf["accessors"].push_back({{"bufferView", view(first, surface.vertexCount * sizeof(glm::vec3))},
                                     {"componentType", 5126},
                                     {"count", surface.vertexCount},
                                     {"type", "VEC3"},
                                     {"min", {low.x, low.y, low.z}},
                                     {"max", {high.x, high.y, high.z}}});
        gltf["accessors"].push_back({{"bufferView", view(indices.data(), indices.size() * 4)},
                                     {"componentType", 5125},
                                     {"count", indices.size()},
                                     {"type", "SCALAR"}});
        const size_t count = gltf["accessors"].size();
        const glm::vec4 base = material.baseColor;
        gltf["materials"].push_back({{"pbrMetallicRoughness",
                                      {{"baseColorFactor", {base.r, base.g, base.b, base.a}},
                                       {"metallicFactor", material.metallic},
                                       {"roughnessFactor", material.roughness}}},
                                     {"doubleSided", material.doubleSided}});
        gltf["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", count - 2}}},
                                                   {"indices", count - 1},
                                                   {"material", gltf["materials"].size() - 1}});
    }
    const std::string buffer = path + ".bin";
    gltf["buffers"] = {{{"byteLength", bytes.size()}, {"uri", buffer.substr(buffer.rfind('/') + 1)}}};
    std::ofstream(buffer, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
    std::ofstream(path) << gltf.dump();
}

}  // namespace phat::test
