#include "io/gltf/gltf_mesh.h"

#include <fmt/core.h>

#include <numeric>

#include "io/gltf/gltf_accessor.h"
#include "io/gltf/gltf_tangents.h"

namespace phat::gltf {
namespace {

int attribute(const tinygltf::Primitive& primitive, const char* name) {
    const auto it = primitive.attributes.find(name);
    return it == primitive.attributes.end() ? -1 : it->second;
}

uint64_t triangleCount(int mode, uint64_t corners) {
    if (mode == TINYGLTF_MODE_TRIANGLES) return corners / 3;
    return corners < 3 ? 0 : corners - 2;
}

// Specification, section 3.7.2.1: strips turn every second triangle around, fans share their first corner.
std::vector<glm::uvec3> assemble(int mode, const std::vector<uint32_t>& corners, Notes& notes) {
    std::vector<glm::uvec3> triangles(triangleCount(mode, corners.size()));
    for (size_t i = 0; i < triangles.size(); ++i) {
        if (mode == TINYGLTF_MODE_TRIANGLES) {
            triangles[i] = {corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]};
        } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
            const size_t odd = i % 2;
            triangles[i] = {corners[i], corners[i + 1 + odd], corners[i + 2 - odd]};
        } else {
            triangles[i] = {corners[i + 1], corners[i + 2], corners[0]};
        }
    }
    if (mode == TINYGLTF_MODE_TRIANGLES && corners.size() % 3 != 0) ++notes.incompleteTriangles;
    return triangles;
}

template <typename T>
void pickVertices(std::vector<T>& values, const std::vector<uint32_t>& from) {
    std::vector<T> picked(from.size());
    for (size_t i = 0; i < from.size(); ++i) picked[i] = values[from[i]];
    values = std::move(picked);
}

template <typename T>
void appendCopies(std::vector<T>& values, const std::vector<uint32_t>& from) {
    values.reserve(values.size() + from.size());
    for (const uint32_t vertex : from) values.push_back(values[vertex]);
}

// Specification, section 3.7.2.1: without normals, flat ones.
void makeFlat(MeshPart& part) {
    std::vector<uint32_t> cornerVertices;
    cornerVertices.reserve(part.triangles.size() * 3);
    for (glm::uvec3& t : part.triangles) {
        const uint32_t first = uint32_t(cornerVertices.size());
        for (int corner = 0; corner < 3; ++corner) cornerVertices.push_back(t[corner]);
        t = {first, first + 1, first + 2};
    }
    pickVertices(part.positions, cornerVertices);
    pickVertices(part.uv0, cornerVertices);
    pickVertices(part.uv1, cornerVertices);
    pickVertices(part.colors, cornerVertices);
    part.normals.resize(part.positions.size());
    for (const glm::uvec3& t : part.triangles) {
        // In double: small triangles far from the origin.
        const glm::dvec3 p = part.positions[t[0]];
        const glm::dvec3 normal =
            glm::cross(glm::dvec3(part.positions[t[1]]) - p, glm::dvec3(part.positions[t[2]]) - p);
        const double length = glm::length(normal);
        const glm::vec3 unit = length > 0 ? glm::vec3(normal / length) : glm::vec3(0);
        for (int corner = 0; corner < 3; ++corner) part.normals[t[corner]] = unit;
    }
}

bool finite(glm::vec4 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

void repairUvs(std::vector<glm::vec2>& uvs, Notes& notes) {
    // Farther out, a float cannot tell texels apart.
    constexpr float kMaxUv = 1e6f;
    for (glm::vec2& uv : uvs) {
        if (std::abs(uv.x) <= kMaxUv && std::abs(uv.y) <= kMaxUv) continue;
        uv = glm::vec2(0);
        ++notes.repairedUvs;
    }
}

// Specification, section 3.7.2.1: colours are clamped to [0,1]; three components are opaque. Unnormalised
// integers are illegal but plainly meant.
void readColors(const Document& document, int accessor, MeshPart& part, Notes& notes) {
    if (accessor < 0) {
        part.colors.assign(part.positions.size(), glm::vec4(1));
        return;
    }
    const auto& info = document.model().accessors[size_t(accessor)];
    const bool integer = info.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT;
    if (info.type == TINYGLTF_TYPE_VEC3) {
        for (const glm::vec3& rgb : readVectors<3>(document, accessor, integer))
            part.colors.emplace_back(rgb, 1.0f);
    } else {
        part.colors = readVectors<4>(document, accessor, integer);
    }
    for (glm::vec4& color : part.colors) {
        if (!finite(color)) {
            color = glm::vec4(1);
            ++notes.repairedColors;
        }
        color = glm::clamp(color, 0.0f, 1.0f);
    }
}

std::vector<glm::vec2> readUvs(const Document& document, int accessor, size_t count, Notes& notes) {
    if (accessor < 0) return std::vector<glm::vec2>(count, glm::vec2(0));
    std::vector<glm::vec2> uvs = readVectors<2>(document, accessor);
    repairUvs(uvs, notes);
    return uvs;
}

// Vertices that a generator can divide by; NaN normals would spread through the sums.
std::vector<glm::vec3> unitOrUp(const std::vector<glm::vec3>& normals) {
    std::vector<glm::vec3> unit(normals.size());
    for (size_t i = 0; i < normals.size(); ++i) {
        const float length = glm::length(normals[i]);
        unit[i] = length > 0 && std::isfinite(length) ? normals[i] / length : glm::vec3(0, 1, 0);
    }
    return unit;
}

void makeTangents(MeshPart& part, const TextureSlot& slot) {
    std::vector<glm::vec2> uvs = slot.uvSet == 1 ? part.uv1 : part.uv0;
    for (glm::vec2& uv : uvs) uv = slot.uvTransform * glm::vec3(uv, 1);
    const std::vector<glm::vec3> normals = unitOrUp(part.normals);
    TangentOutput generated = generateTangents({part.positions, normals, uvs}, part.triangles);
    part.tangents = std::move(generated.tangents);
    appendCopies(part.positions, generated.splitFrom);
    appendCopies(part.normals, generated.splitFrom);
    appendCopies(part.uv0, generated.splitFrom);
    appendCopies(part.uv1, generated.splitFrom);
    appendCopies(part.colors, generated.splitFrom);
}

}  // namespace

uint64_t PartSize::bytes() const {
    constexpr uint64_t kVertexBytes = 2 * sizeof(glm::vec3) + 2 * sizeof(glm::vec4) + 2 * sizeof(glm::vec2);
    constexpr uint64_t kTriangleBytes = sizeof(glm::uvec3) + sizeof(uint32_t);
    return vertices * kVertexBytes + triangles * kTriangleBytes;
}

PartSize partSize(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
    const auto count = [&](int accessor) { return uint64_t(model.accessors[size_t(accessor)].count); };
    const uint64_t vertices = count(attribute(primitive, "POSITION"));
    PartSize size;
    size.triangles =
        triangleCount(primitive.mode, primitive.indices < 0 ? vertices : count(primitive.indices));
    size.vertices = attribute(primitive, "NORMAL") < 0 ? 3 * size.triangles : vertices;
    return size;
}

bool hasTriangles(const tinygltf::Primitive& primitive, Notes& notes) {
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
        ++notes.pointAndLinePrimitives;
        return false;
    }
    if (attribute(primitive, "POSITION") < 0) {
        ++notes.primitivesWithoutPositions;
        return false;
    }
    return true;
}

MeshPart readPart(const Document& document, const tinygltf::Primitive& primitive, const Material& material,
                  Notes& notes) {
    MeshPart part;
    part.positions = readVectors<3>(document, attribute(primitive, "POSITION"));
    const size_t count = part.positions.size();
    part.uv0 = readUvs(document, attribute(primitive, "TEXCOORD_0"), count, notes);
    part.uv1 = readUvs(document, attribute(primitive, "TEXCOORD_1"), count, notes);
    readColors(document, attribute(primitive, "COLOR_0"), part, notes);

    std::vector<uint32_t> corners;
    if (primitive.indices >= 0) {
        corners = readIndices(document, primitive.indices, count);
    } else {
        corners.resize(count);
        std::iota(corners.begin(), corners.end(), 0u);
    }
    part.triangles = assemble(primitive.mode, corners, notes);

    const int normals = attribute(primitive, "NORMAL");
    // Without normals given tangents mean nothing (specification, section 3.7.2.1).
    const int tangents = normals < 0 ? -1 : attribute(primitive, "TANGENT");
    if (normals >= 0) {
        part.normals = readVectors<3>(document, normals, true);
    } else {
        makeFlat(part);
    }
    const TextureSlot& normalMap =
        material.normalTexture.image >= 0 ? material.normalTexture : material.clearcoatNormalTexture;
    if (normalMap.image < 0) {
        part.tangents.assign(part.positions.size(), glm::vec4(0));
    } else if (tangents >= 0) {
        part.tangents = readVectors<4>(document, tangents, true);
    } else {
        makeTangents(part, normalMap);
    }
    return part;
}

}  // namespace phat::gltf
