#include <fmt/core.h>

#include <cmath>

#include "io/gltf/gltf_document.h"

namespace phat::gltf {
namespace {

void require(bool good, std::string_view where, size_t index, std::string_view what) {
    if (!good) throw Problem(fmt::format("{} {}: {}", where, index, what));
}

// -1 stands for "not given".
bool optionalIndex(int index, size_t size) {
    return index == -1 || (index >= 0 && size_t(index) < size);
}
bool validIndex(int index, size_t size) {
    return index >= 0 && size_t(index) < size;
}

bool knownComponentType(int type) {
    return tinygltf::GetComponentSizeInBytes(uint32_t(type)) > 0 && type != TINYGLTF_COMPONENT_TYPE_INT &&
           type != TINYGLTF_COMPONENT_TYPE_DOUBLE;
}

void checkBufferViews(const Document& document) {
    const auto& views = document.model().bufferViews;
    for (size_t i = 0; i < views.size(); ++i) {
        const auto& view = views[i];
        require(validIndex(view.buffer, document.source.buffers.size()), "buffer view", i, "no such buffer");
        const uint64_t size = bufferBytes(document.source, uint64_t(view.buffer)).size();
        require(view.byteOffset <= size && view.byteLength <= size - view.byteOffset, "buffer view", i,
                "lies outside its buffer");
        const bool stride = view.byteStride == 0 || (view.byteStride >= 4 && view.byteStride <= 252);
        require(stride, "buffer view", i, "byteStride is not from 4 to 252");
    }
}

// Whether `count` elements fit into a view; no product can wrap.
bool fits(const tinygltf::BufferView& view, uint64_t offset, uint64_t count, uint64_t stride,
          uint64_t element) {
    if (offset > view.byteLength || element > view.byteLength - offset) return false;
    return (count - 1) <= (view.byteLength - offset - element) / stride;
}

void checkSparse(const Document& document, size_t index) {
    const auto& model = document.model();
    const auto& accessor = model.accessors[index];
    const auto& sparse = accessor.sparse;
    require(sparse.count > 0 && uint64_t(sparse.count) <= accessor.count, "accessor", index,
            "its sparse count is wrong");
    const int type = sparse.indices.componentType;
    require(type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
            "accessor", index, "its sparse indices have a wrong component type");
    require(validIndex(sparse.indices.bufferView, model.bufferViews.size()) &&
                validIndex(sparse.values.bufferView, model.bufferViews.size()) &&
                sparse.indices.byteOffset >= 0 && sparse.values.byteOffset >= 0,
            "accessor", index, "its sparse data do not exist");
    const uint64_t indexSize = uint64_t(tinygltf::GetComponentSizeInBytes(uint32_t(type)));
    const uint64_t valueSize = elementSize(accessor);
    const bool inside =
        fits(model.bufferViews[size_t(sparse.indices.bufferView)], uint64_t(sparse.indices.byteOffset),
             uint64_t(sparse.count), indexSize, indexSize) &&
        fits(model.bufferViews[size_t(sparse.values.bufferView)], uint64_t(sparse.values.byteOffset),
             uint64_t(sparse.count), valueSize, valueSize);
    require(inside, "accessor", index, "its sparse data lie outside their buffer view");
}

void checkAccessors(const Document& document) {
    const auto& model = document.model();
    for (size_t i = 0; i < model.accessors.size(); ++i) {
        const auto& accessor = model.accessors[i];
        require(knownComponentType(accessor.componentType), "accessor", i, "unknown component type");
        require(accessor.count > 0, "accessor", i, "count is 0");
        require(optionalIndex(accessor.bufferView, model.bufferViews.size()), "accessor", i,
                "no such buffer view");
        if (accessor.bufferView >= 0) {
            const auto& view = model.bufferViews[size_t(accessor.bufferView)];
            const uint64_t size = elementSize(accessor);
            const uint64_t stride = view.byteStride == 0 ? size : view.byteStride;
            require(stride >= size, "accessor", i, "its elements overlap");
            require(fits(view, accessor.byteOffset, accessor.count, stride, size), "accessor", i,
                    "lies outside its buffer view");
        }
        if (accessor.sparse.isSparse) checkSparse(document, i);
    }
}

void checkMeshes(const tinygltf::Model& model) {
    for (size_t i = 0; i < model.meshes.size(); ++i) {
        for (const auto& primitive : model.meshes[i].primitives) {
            require(primitive.mode >= TINYGLTF_MODE_POINTS && primitive.mode <= TINYGLTF_MODE_TRIANGLE_FAN,
                    "mesh", i, fmt::format("primitive mode {} does not exist", primitive.mode));
            require(optionalIndex(primitive.material, model.materials.size()), "mesh", i,
                    fmt::format("material {} does not exist", primitive.material));
            require(optionalIndex(primitive.indices, model.accessors.size()), "mesh", i,
                    "no such index accessor");
            const auto position = primitive.attributes.find("POSITION");
            for (const auto& [name, accessor] : primitive.attributes) {
                require(validIndex(accessor, model.accessors.size()), "mesh", i,
                        fmt::format("no such accessor for {}", name.substr(0, 40)));
                // The positions' own index may come later in the map, so it is checked here too.
                if (position == primitive.attributes.end() ||
                    !validIndex(position->second, model.accessors.size())) {
                    continue;
                }
                require(model.accessors[size_t(accessor)].count ==
                            model.accessors[size_t(position->second)].count,
                        "mesh", i, fmt::format("{} and POSITION differ in count", name.substr(0, 40)));
            }
        }
    }
}

void checkNodes(const tinygltf::Model& model) {
    for (size_t i = 0; i < model.nodes.size(); ++i) {
        const auto& node = model.nodes[i];
        require(optionalIndex(node.mesh, model.meshes.size()), "node", i, "no such mesh");
        require(optionalIndex(node.camera, model.cameras.size()), "node", i, "no such camera");
        for (const int child : node.children) {
            require(validIndex(child, model.nodes.size()), "node", i,
                    fmt::format("child {} does not exist", child));
        }
        const auto sized = [](const std::vector<double>& v, size_t n) { return v.empty() || v.size() == n; };
        require(sized(node.matrix, 16) && sized(node.translation, 3) && sized(node.rotation, 4) &&
                    sized(node.scale, 3),
                "node", i, "its transform has the wrong number of elements");
        // Far nodes are legal; what they carry is dropped by its coordinates.
        for (const auto* numbers : {&node.matrix, &node.translation, &node.rotation, &node.scale}) {
            for (const double number : *numbers) require(std::isfinite(number), "node", i, "not finite");
        }
        if (const auto light = node.extensions.find("KHR_lights_punctual"); light != node.extensions.end()) {
            require(light->second.Has("light") && light->second.Get("light").IsInt() &&
                        validIndex(light->second.Get("light").GetNumberAsInt(), model.lights.size()),
                    "node", i, "no such light");
        }
    }
    for (size_t i = 0; i < model.scenes.size(); ++i) {
        for (const int node : model.scenes[i].nodes) {
            require(validIndex(node, model.nodes.size()), "scene", i,
                    fmt::format("node {} does not exist", node));
        }
    }
    require(optionalIndex(model.defaultScene, model.scenes.size()), "scene",
            size_t(std::max(model.defaultScene, 0)), "does not exist");
}

void checkMaterials(const Document& document) {
    const auto& model = document.model();
    for (size_t i = 0; i < model.textures.size(); ++i) {
        require(optionalIndex(model.textures[i].source, document.description.images.size()), "texture", i,
                "no such image");
        require(optionalIndex(model.textures[i].sampler, model.samplers.size()), "texture", i,
                "no such sampler");
    }
    for (size_t i = 0; i < document.description.images.size(); ++i) {
        require(optionalIndex(document.description.images[i].bufferView, model.bufferViews.size()), "image",
                i, "no such buffer view");
    }
    for (size_t i = 0; i < model.materials.size(); ++i) {
        const auto& material = model.materials[i];
        const auto& pbr = material.pbrMetallicRoughness;
        for (const int texture :
             {pbr.baseColorTexture.index, pbr.metallicRoughnessTexture.index, material.normalTexture.index,
              material.occlusionTexture.index, material.emissiveTexture.index}) {
            require(optionalIndex(texture, model.textures.size()), "material", i,
                    fmt::format("texture {} does not exist", texture));
        }
    }
}

}  // namespace

size_t elementSize(const tinygltf::Accessor& accessor) {
    const auto components = tinygltf::GetNumComponentsInType(uint32_t(accessor.type));
    const auto bytes = tinygltf::GetComponentSizeInBytes(uint32_t(accessor.componentType));
    return size_t(components) * size_t(bytes);
}

void checkModel(const Document& document) {
    const auto& model = document.model();
    checkBufferViews(document);
    checkAccessors(document);
    checkMeshes(model);
    checkNodes(model);
    checkMaterials(document);
}

}  // namespace phat::gltf
