#include "io/gltf/gltf_divide.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <map>

#include "io/gltf/gltf_json.h"

namespace phat::gltf {
namespace {

using nlohmann::json;

// A divided surface in terms of the file's vertices.
struct FileParts {
    const DividedSurface* divided = nullptr;
    const Surface* surface = nullptr;
    std::vector<CutVertex> vertices;  // from: of the file's primitive and its new vertices
    std::vector<std::vector<uint32_t>> indicesOfPart;
    uint32_t vertexCount = 0;  // of the file's primitive
};

FileParts filePartsOf(const GltfSource& source, const Scene& scene, const DividedSurface& divided) {
    const Surface& surface = scene.surfaces[divided.surface];
    const SurfaceCorners corners = surfaceCorners(source, scene, surface);
    std::vector<uint32_t> fileVertex(surface.vertexCount, 0);
    for (uint32_t t = 0; t < surface.triangleCount; ++t)
        for (int corner = 0; corner < 3; ++corner)
            fileVertex[scene.triangles[surface.firstTriangle + t][corner] - surface.firstVertex] =
                corners.vertices[t][corner];
    const auto inFile = [&](uint32_t vertex) {
        return vertex < surface.vertexCount ? fileVertex[vertex]
                                            : corners.vertexCount + vertex - surface.vertexCount;
    };
    FileParts parts{&divided, &surface, divided.vertices, {}, corners.vertexCount};
    for (CutVertex& vertex : parts.vertices)
        for (uint32_t& from : vertex.from) from = inFile(from);
    parts.indicesOfPart.resize(divided.partCount);
    for (size_t t = 0; t < divided.triangles.size(); ++t)
        for (int slot = 0; slot < 3; ++slot)
            parts.indicesOfPart[divided.part[t]].push_back(
                inFile(divided.triangles[t][swappedCorner(slot, corners.swapped)]));
    return parts;
}

template <typename T>
std::vector<uint8_t> bytesOf(const std::vector<T>& values) {
    std::vector<uint8_t> bytes(values.size() * sizeof(T));
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

uint32_t componentsOf(const json& accessor) {
    const std::string type = accessor.at("type").get<std::string>();
    if (type == "SCALAR") return 1;
    if (type.size() == 4 && type.starts_with("VEC")) return uint32_t(type[3] - '0');
    throw Problem(fmt::format("a vertex attribute of type {}", type));
}

// Directions are unit where those that they come from are.
void normalize(float* direction, const float* fallback) {
    const double length = std::hypot(double(direction[0]), double(direction[1]), double(direction[2]));
    for (int c = 0; c < 3; ++c) direction[c] = length > 0 ? float(direction[c] / length) : fallback[c];
}

// The attribute with the new vertices, as floats.
size_t extendedAttribute(GltfSource& source, const std::string& name, uint64_t index,
                         const FileParts& parts) {
    const json accessor = gltfItem(source.json, "accessors", index);
    const uint32_t components = componentsOf(accessor);
    // Colours that are whole numbers are meant to be fractions of the largest one.
    std::vector<float> values =
        accessorFloats(source, index, components, name.starts_with("COLOR_"), parts.vertexCount);
    values.reserve(values.size() + components * parts.vertices.size());
    for (const CutVertex& vertex : parts.vertices) {
        const size_t first = values.size();
        for (uint32_t c = 0; c < components; ++c) {
            double sum = 0;
            for (int i = 0; i < 3; ++i)
                sum += vertex.weight[i] * double(values[size_t(components) * vertex.from[i] + c]);
            values.push_back(float(sum));
        }
        const float* source0 = &values[size_t(components) * vertex.from[0]];
        if (name == "NORMAL" || name == "TANGENT") normalize(&values[first], source0);
        if (name == "TANGENT" && components == 4) values[first + 3] = source0[3];  // the handedness
    }
    return addAccessor(
        source,
        {{"componentType", kFloat}, {"type", accessor.at("type")}, {"count", values.size() / components}},
        bytesOf(values));
}

json partPrimitive(GltfSource& source, const json& shared, std::vector<uint32_t> indices) {
    json primitive = shared;
    const size_t count = indices.size();
    primitive["indices"] = addAccessor(
        source, {{"componentType", kUnsignedInt}, {"type", "SCALAR"}, {"count", count}}, bytesOf(indices));
    return primitive;
}

void divide(GltfSource& source, uint64_t mesh, const FileParts& parts, MemoryBudget& budget) {
    json shared = gltfItem(source.json, "meshes", mesh).at("primitives").at(parts.surface->primitive);
    // Of each vertex at most ten vectors of four.
    constexpr uint64_t kVertexBytes = 160;
    budget.charge(
        kVertexBytes * (parts.vertexCount + parts.vertices.size()) + 12 * parts.divided->triangles.size(),
        "its divided meshes");
    for (auto& [name, accessor] : shared.at("attributes").items())
        accessor = extendedAttribute(source, name, accessor.get<uint64_t>(), parts);
    for (const char* key : {"mode", "targets"}) shared.erase(key);
    for (size_t part = 0; part < parts.indicesOfPart.size(); ++part) {
        json primitive = partPrimitive(source, shared, parts.indicesOfPart[part]);
        json& primitives = source.json["meshes"][mesh]["primitives"];
        if (part == 0)
            primitives[parts.surface->primitive] = std::move(primitive);
        else
            primitives.push_back(std::move(primitive));
    }
}

// Meshes by node; one that other nodes show, too, is copied.
class OwnMeshes {
  public:
    explicit OwnMeshes(json& gltf) : gltf_(gltf) {
        for (size_t n = 0; n < countOf(gltf, "nodes"); ++n)
            if (gltf["nodes"][n].contains("mesh")) ++users_[wholeNumber(gltf["nodes"][n], "mesh")];
    }

    uint64_t meshOf(const Surface& surface) {
        const auto [found, isNew] = own_.try_emplace(surface.node, surface.mesh);
        if (isNew && users_[surface.mesh]-- > 1) {
            json copy = gltf_["meshes"][surface.mesh];
            found->second = gltf_["meshes"].size();
            gltf_["meshes"].push_back(std::move(copy));
            gltf_["nodes"][surface.node]["mesh"] = found->second;
        }
        return found->second;
    }

  private:
    json& gltf_;
    std::map<uint64_t, size_t> users_;  // by mesh
    std::map<uint32_t, uint64_t> own_;  // by node
};

}  // namespace

void dividePrimitives(GltfSource& source, const Scene& scene, std::span<const DividedSurface> divided,
                      MemoryBudget& budget) {
    std::vector<FileParts> all;  // before the first change
    for (const DividedSurface& surface : divided) all.push_back(filePartsOf(source, scene, surface));
    OwnMeshes meshes(source.json);
    std::map<uint32_t, uint64_t> meshOfNode;
    for (const FileParts& parts : all) meshOfNode[parts.surface->node] = meshes.meshOf(*parts.surface);
    for (const FileParts& parts : all) divide(source, meshOfNode[parts.surface->node], parts, budget);
}

}  // namespace phat::gltf
