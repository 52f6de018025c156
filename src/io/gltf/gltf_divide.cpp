#include "io/gltf/gltf_divide.h"

#include <fmt/format.h>

#include <cmath>

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
    return addFloats(source, values, components);
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
        json primitive = shared;
        primitive["indices"] = addIndices(source, parts.indicesOfPart[part]);
        json& primitives = source.json["meshes"][mesh]["primitives"];
        if (part == 0)
            primitives[parts.surface->primitive] = std::move(primitive);
        else
            primitives.push_back(std::move(primitive));
    }
}

}  // namespace

void dividePrimitives(GltfSource& source, const Scene& scene, std::span<const DividedSurface> divided,
                      MemoryBudget& budget) {
    std::vector<FileParts> all;  // before the first change
    for (const DividedSurface& surface : divided) all.push_back(filePartsOf(source, scene, surface));
    std::vector<Surface> surfaces;
    for (const FileParts& parts : all) surfaces.push_back(*parts.surface);
    const std::vector<size_t> meshOfSurface = giveNodesTheirOwnMeshes(source.json, surfaces);
    for (size_t i = 0; i < all.size(); ++i) divide(source, meshOfSurface[i], all[i], budget);
}

}  // namespace phat::gltf
