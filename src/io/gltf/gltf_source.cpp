#include "io/gltf/gltf_source.h"

#include <fmt/format.h>

#include <cassert>
#include <cstring>
#include <numeric>
#include <string_view>
#include <utility>

#include "io/base/file_error.h"
#include "io/base/json_depth.h"
#include "io/gltf/gltf_container.h"

namespace phat {
namespace {

using nlohmann::json;

[[noreturn]] void fail(const std::string& reason) {
    throw std::runtime_error(reason);
}

// The loader has read the same files before, within its own limits.
constexpr uint64_t kNoLimit = ~0ull;

// Chunks that are padded with zeros instead of spaces are common enough; the parser takes a zero for the end.
json parseJson(const std::string& text) {
    json parsed = json::parse(text, nullptr, /*allow_exceptions=*/false);
    if (!parsed.is_object()) fail("not a glTF file: its JSON cannot be parsed");
    if (isNestedTooDeeply(text)) fail("its JSON is nested too deeply");
    return parsed;
}

uint32_t componentSize(uint64_t componentType) {
    switch (componentType) {
        case 5120:
        case 5121:
            return 1;
        case 5122:
        case 5123:
            return 2;
        case 5125:
        case 5126:
            return 4;
        default:
            fail(fmt::format("component type {} does not exist", componentType));
    }
}

struct Shape {
    uint32_t columns, rows;
};

Shape shapeOf(const std::string& type) {
    if (type == "SCALAR") return {1, 1};
    if (type == "VEC2") return {1, 2};
    if (type == "VEC3") return {1, 3};
    if (type == "VEC4") return {1, 4};
    if (type == "MAT2") return {2, 2};
    if (type == "MAT3") return {3, 3};
    if (type == "MAT4") return {4, 4};
    fail("accessor type \"" + type + "\" does not exist");
}

// `count` elements of `size` bytes, `stride` apart, as one range of the view; checks without overflow.
std::span<const uint8_t> stridedRange(std::span<const uint8_t> view, uint64_t offset, uint64_t count,
                                      uint64_t size, uint64_t stride) {
    if (count == 0) return {};
    if (offset > view.size() || view.size() - offset < size || stride < size ||
        (view.size() - offset - size) / stride < count - 1)
        fail("an accessor reaches past its bufferView");
    return view.subspan(offset, (count - 1) * stride + size);
}

uint64_t indexAt(std::span<const uint8_t> bytes, uint32_t size, uint64_t i) {
    uint32_t value = 0;
    std::memcpy(&value, bytes.data() + i * size, size);
    return value;
}

void applySparse(const GltfSource& source, const json& sparse, AccessorElements& elements) {
    const uint64_t count = wholeNumber(sparse, "count");
    if (count > elements.count) fail("a sparse accessor has more elements than its base");
    const json& indices = sparse.at("indices");
    const uint32_t indexSize = componentSize(wholeNumber(indices, "componentType"));
    const auto indexBytes = stridedRange(bufferViewBytes(source, wholeNumber(indices, "bufferView")),
                                         wholeNumber(indices, "byteOffset", 0), count, indexSize, indexSize);
    const json& values = sparse.at("values");
    const auto valueBytes =
        stridedRange(bufferViewBytes(source, wholeNumber(values, "bufferView")),
                     wholeNumber(values, "byteOffset", 0), count, elements.elementSize, elements.elementSize);
    for (uint64_t i = 0; i < count; ++i) {
        const uint64_t target = indexAt(indexBytes, indexSize, i);
        if (target >= elements.count) fail("a sparse accessor's index is out of range");
        std::memcpy(elements.bytes.data() + target * elements.elementSize,
                    valueBytes.data() + i * elements.elementSize, elements.elementSize);
    }
}

using Corners = std::array<uint32_t, 3>;

int signOf(double value) {
    return (value > 0) - (value < 0);
}

int determinantSign(const json& node) {
    if (node.contains("matrix")) {
        const auto m = node["matrix"].get<std::array<double, 16>>();
        return signOf(m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) +
                      m[8] * (m[1] * m[6] - m[2] * m[5]));
    }
    const auto scale = node.value("scale", std::array<double, 3>{1, 1, 1});
    return signOf(scale[0]) * signOf(scale[1]) * signOf(scale[2]);
}

// The sign of a product of matrices' determinants is the product of the signs.
bool isMirrored(const json& gltf, const Scene& scene, uint64_t node) {
    const json& nodes = gltf.at("nodes");
    int sign = determinantSign(nodes.at(node));
    for (int32_t up = scene.nodes.at(node).parent; up >= 0; up = scene.nodes[size_t(up)].parent)
        sign *= determinantSign(nodes.at(size_t(up)));
    return sign < 0;
}

}  // namespace

uint64_t wholeNumber(const json& object, const char* key, std::optional<uint64_t> fallback) {
    const auto found = object.find(key);
    if (found == object.end()) {
        if (!fallback) fail(fmt::format("\"{}\" is missing", key));
        return *fallback;
    }
    if (found->is_number_unsigned()) return found->get<uint64_t>();
    // Some writers put 3.0 where glTF asks for 3.
    if (found->is_number_float()) {
        const double value = found->get<double>();
        if (value >= 0 && value < 0x1p53 && value == double(uint64_t(value))) return uint64_t(value);
    }
    fail(fmt::format("\"{}\" is not a whole number", key));
}

const json& gltfItem(const json& json, const char* array, uint64_t index) {
    const auto found = json.find(array);
    if (found == json.end() || !found->is_array() || index >= found->size() || !(*found)[index].is_object())
        fail(fmt::format("there is no {}[{}]", array, index));
    return (*found)[index];
}

GltfSource openGltf(const std::string& path) {
    try {
        GltfSource source;
        source.path = path;
        gltf::Container container = gltf::readContainer(path);
        source.json = parseJson(container.json);
        source.fileBytes = container.json.size() + container.binary.size();
        if (container.hasBinary) source.binary = std::move(container.binary);
        return source;
    } catch (const std::runtime_error& error) {
        throw FileError(path, error.what());
    }
}

void readGltfBuffers(GltfSource& source) {
    assert(source.buffers.empty());
    const json buffers = source.json.value("buffers", json::array());
    for (size_t i = 0; i < buffers.size(); ++i) {
        std::vector<uint8_t>& data = source.buffers.emplace_back();
        const auto uri = buffers[i].find("uri");
        if (uri != buffers[i].end() && uri->is_string())
            data = readGltfUri(source, uri->get<std::string>());
        else if (i == 0 && source.binary)
            data = *std::exchange(source.binary, std::nullopt);
    }
}

std::filesystem::path gltfFolder(const GltfSource& source) {
    const std::filesystem::path folder = std::filesystem::path(source.path).parent_path();
    return folder.empty() ? "." : folder;
}

std::vector<uint8_t> readGltfUri(const GltfSource& source, const std::string& uri) {
    return gltf::readUri(uri, gltfFolder(source), kNoLimit);
}

std::span<const uint8_t> bufferBytes(const GltfSource& source, uint64_t index) {
    if (index < source.bufferProblems.size() && !source.bufferProblems[index].empty())
        fail(source.bufferProblems[index]);
    if (index >= source.buffers.size()) fail(fmt::format("there is no buffers[{}]", index));
    return source.buffers[index];
}

std::span<const uint8_t> bufferViewBytes(const GltfSource& source, uint64_t index) {
    const json& view = gltfItem(source.json, "bufferViews", index);
    const std::span<const uint8_t> bytes = bufferBytes(source, wholeNumber(view, "buffer"));
    const uint64_t offset = wholeNumber(view, "byteOffset", 0);
    const uint64_t length = wholeNumber(view, "byteLength");
    if (offset > bytes.size() || length > bytes.size() - offset) fail("a bufferView reaches past its buffer");
    return bytes.subspan(offset, length);
}

AccessorElements readAccessor(const GltfSource& source, uint64_t index,
                              std::optional<uint64_t> expectedCount) {
    const json& accessor = gltfItem(source.json, "accessors", index);
    AccessorElements elements;
    elements.count = wholeNumber(accessor, "count");
    if (expectedCount && elements.count != *expectedCount)
        fail(fmt::format("accessors[{}] has {} elements instead of {}", index, elements.count,
                         *expectedCount));
    elements.componentType = uint32_t(wholeNumber(accessor, "componentType"));
    const Shape shape = shapeOf(accessor.at("type").get<std::string>());
    const uint32_t columnSize = shape.rows * componentSize(elements.componentType);
    // Columns of matrices start at multiples of 4 bytes (glTF 2.0, section 3.6.2.4).
    elements.elementSize = shape.columns == 1 ? columnSize : shape.columns * ((columnSize + 3) / 4 * 4);
    elements.components = shape.columns * shape.rows;

    if (accessor.contains("bufferView")) {
        const uint64_t viewIndex = wholeNumber(accessor, "bufferView");
        const auto view = bufferViewBytes(source, viewIndex);
        const uint64_t stride =
            wholeNumber(gltfItem(source.json, "bufferViews", viewIndex), "byteStride", elements.elementSize);
        const auto range = stridedRange(view, wholeNumber(accessor, "byteOffset", 0), elements.count,
                                        elements.elementSize, stride);
        elements.bytes.resize(elements.count * elements.elementSize);
        for (uint64_t i = 0; i < elements.count; ++i)
            std::memcpy(elements.bytes.data() + i * elements.elementSize, range.data() + i * stride,
                        elements.elementSize);
    } else {
        // Zeros by the specification; only a count that someone else has vouched for is allocated.
        if (!expectedCount) fail(fmt::format("accessors[{}] has no bufferView", index));
        elements.bytes.resize(elements.count * elements.elementSize);
    }
    if (accessor.contains("sparse")) applySparse(source, accessor["sparse"], elements);
    return elements;
}

std::vector<Corners> primitiveTriangles(const GltfSource& source, const json& primitive,
                                        uint32_t vertexCount) {
    std::vector<uint32_t> order;
    if (primitive.contains("indices")) {
        const AccessorElements indices = readAccessor(source, wholeNumber(primitive, "indices"));
        for (uint64_t i = 0; i < indices.count; ++i)
            order.push_back(uint32_t(indexAt(indices.bytes, indices.elementSize, i)));
    } else {
        order.resize(vertexCount);
        std::iota(order.begin(), order.end(), 0u);
    }
    for (const uint32_t vertex : order)
        if (vertex >= vertexCount) fail("a vertex index is out of range");

    constexpr uint64_t kList = 4, kStrip = 5;
    const uint64_t mode = wholeNumber(primitive, "mode", kList);
    std::vector<Corners> triangles;
    if (mode == kList) {
        for (size_t i = 0; i + 2 < order.size(); i += 3)
            triangles.push_back({order[i], order[i + 1], order[i + 2]});
    } else {
        for (size_t i = 0; i + 2 < order.size(); ++i) {
            const size_t odd = i % 2;
            if (mode == kStrip)
                triangles.push_back({order[i], order[i + 1 + odd], order[i + 2 - odd]});
            else
                triangles.push_back({order[i + 1], order[i + 2], order[0]});
        }
    }
    return triangles;
}

SurfaceCorners surfaceCorners(const GltfSource& source, const Scene& scene, const Surface& surface) {
    const json& primitive =
        gltfItem(source.json, "meshes", surface.mesh).at("primitives").at(surface.primitive);
    const json& attributes = primitive.at("attributes");
    const json& positions = gltfItem(source.json, "accessors", wholeNumber(attributes, "POSITION"));
    SurfaceCorners corners;
    corners.vertexCount = uint32_t(wholeNumber(positions, "count"));
    corners.swapped = isMirrored(source.json, scene, surface.node);
    const std::vector<Corners> listed = primitiveTriangles(source, primitive, corners.vertexCount);

    // Without normals every corner has a vertex of its own, in the order of the file.
    const bool flat = !attributes.contains("NORMAL");
    const auto isSame = [&](uint32_t sceneVertex, const Corners& triangle, size_t triangleIndex, int corner) {
        if (flat) return sceneVertex == 3 * triangleIndex + corner;
        if (sceneVertex < corners.vertexCount) return sceneVertex == triangle[corner];
        // Split for tangents: such copies come last.
        return sceneVertex < surface.vertexCount && triangle[corner] < surface.vertexCount &&
               scene.positions[surface.firstVertex + sceneVertex] ==
                   scene.positions[surface.firstVertex + triangle[corner]];
    };
    size_t next = 0;  // triangles that could not be placed are missing in the scene
    for (uint32_t t = 0; t < surface.triangleCount; ++t) {
        const glm::uvec3 triangle = scene.triangles[surface.firstTriangle + t] - surface.firstVertex;
        const auto matches = [&](const Corners& candidate) {
            for (int slot = 0; slot < 3; ++slot)
                if (!isSame(triangle[swappedCorner(slot, corners.swapped)], candidate, next, slot))
                    return false;
            return true;
        };
        while (next < listed.size() && !matches(listed[next])) ++next;
        if (next == listed.size()) fail(fmt::format("\"{}\" has changed since it was loaded", surface.name));
        Corners& found = corners.vertices.emplace_back();
        for (int slot = 0; slot < 3; ++slot) found[swappedCorner(slot, corners.swapped)] = listed[next][slot];
        ++next;
    }
    return corners;
}

}  // namespace phat
