#include "io/gltf/gltf_accessor.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

namespace phat::gltf {
namespace {

// glTF data need not be aligned in memory, whatever the file says of offsets.
template <typename T>
T load(const uint8_t* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
}

uint32_t loadIndex(const uint8_t* bytes, int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return load<uint8_t>(bytes);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load<uint16_t>(bytes);
        default:
            return load<uint32_t>(bytes);
    }
}

// Start of a view's data at an offset. pre: checked.
const uint8_t* dataAt(const Document& document, int view, size_t offset) {
    const auto& bufferView = document.model().bufferViews[size_t(view)];
    return document.source.buffers[size_t(bufferView.buffer)].data() + bufferView.byteOffset + offset;
}

// Calls use(element, bytes) for all elements of the base data, then for those that sparse data replace.
template <typename Use>
void forEachElement(const Document& document, int index, Use use) {
    const auto& model = document.model();
    const auto& accessor = model.accessors[size_t(index)];
    const size_t size = elementSize(accessor);
    if (accessor.bufferView >= 0) {
        const size_t viewStride = model.bufferViews[size_t(accessor.bufferView)].byteStride;
        const size_t stride = viewStride == 0 ? size : viewStride;
        const uint8_t* data = dataAt(document, accessor.bufferView, accessor.byteOffset);
        for (size_t i = 0; i < accessor.count; ++i) use(i, data + i * stride);
    }
    const auto& sparse = accessor.sparse;
    if (!sparse.isSparse) return;
    const size_t indexSize =
        size_t(tinygltf::GetComponentSizeInBytes(uint32_t(sparse.indices.componentType)));
    const uint8_t* indices = dataAt(document, sparse.indices.bufferView, size_t(sparse.indices.byteOffset));
    const uint8_t* values = dataAt(document, sparse.values.bufferView, size_t(sparse.values.byteOffset));
    for (size_t i = 0; i < size_t(sparse.count); ++i) {
        const uint32_t element = loadIndex(indices + i * indexSize, sparse.indices.componentType);
        if (element >= accessor.count) {
            throw Problem(
                fmt::format("accessor {}: sparse index {} of {} elements", index, element, accessor.count));
        }
        use(element, values + i * size);
    }
}

}  // namespace

float componentOf(const uint8_t* bytes, int type, bool normalized) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: {
            const float value = load<int8_t>(bytes);
            return normalized ? std::max(value / 127.0f, -1.0f) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
            const float value = load<uint8_t>(bytes);
            return normalized ? value / 255.0f : value;
        }
        case TINYGLTF_COMPONENT_TYPE_SHORT: {
            const float value = load<int16_t>(bytes);
            return normalized ? std::max(value / 32767.0f, -1.0f) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
            const float value = load<uint16_t>(bytes);
            return normalized ? value / 65535.0f : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return float(load<uint32_t>(bytes));
        default:
            return load<float>(bytes);
    }
}

std::vector<float> readFloats(const Document& document, int index, int components, bool asNormalized) {
    const auto& accessor = document.model().accessors[size_t(index)];
    if (tinygltf::GetNumComponentsInType(uint32_t(accessor.type)) != components) {
        throw Problem(fmt::format("accessor {} has not {} components", index, components));
    }
    const int type = accessor.componentType;
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
        throw Problem(
            fmt::format("accessor {} has 32-bit integers, which no vertex attribute may have", index));
    }
    const bool normalized = accessor.normalized || asNormalized;
    const size_t componentSize = size_t(tinygltf::GetComponentSizeInBytes(uint32_t(type)));
    std::vector<float> floats(accessor.count * size_t(components));  // zeros: what no data replace is zero
    forEachElement(document, index, [&](size_t element, const uint8_t* bytes) {
        float* out = &floats[element * size_t(components)];
        for (int c = 0; c < components; ++c)
            out[c] = componentOf(bytes + size_t(c) * componentSize, type, normalized);
    });
    return floats;
}

std::vector<uint32_t> readIndices(const Document& document, int index, size_t vertexCount) {
    const auto& accessor = document.model().accessors[size_t(index)];
    const int type = accessor.componentType;
    const bool legal =
        accessor.type == TINYGLTF_TYPE_SCALAR &&
        (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
    if (!legal) throw Problem(fmt::format("accessor {} is not of the kind that indices have", index));
    std::vector<uint32_t> indices(accessor.count);
    forEachElement(document, index,
                   [&](size_t element, const uint8_t* bytes) { indices[element] = loadIndex(bytes, type); });
    for (const uint32_t vertex : indices) {
        if (vertex >= vertexCount) {
            throw Problem(fmt::format("accessor {}: index {} of {} vertices", index, vertex, vertexCount));
        }
    }
    return indices;
}

}  // namespace phat::gltf
