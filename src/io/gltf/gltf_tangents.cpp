#include "io/gltf/gltf_tangents.h"

#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "core/base/math.h"
#include "core/base/random.h"

namespace phat::gltf {
namespace {

// Position, normal and uv, bit by bit.
using CornerKey = std::array<uint32_t, 8>;

struct CornerHash {
    size_t operator()(const CornerKey& key) const {
        uint64_t hash = 0;
        for (const uint32_t bits : key) hash = mixBits(hash + bits + 0x9e3779b97f4a7c15ull);
        return hash;
    }
};

uint32_t bitsOf(float value) {
    return std::bit_cast<uint32_t>(value + 0.0f);  // -0 and 0 are one value
}

// For each vertex the first one that equals it.
std::vector<uint32_t> weld(const TangentInput& mesh) {
    std::unordered_map<CornerKey, uint32_t, CornerHash> first;
    first.reserve(mesh.positions.size());
    std::vector<uint32_t> representative(mesh.positions.size());
    for (uint32_t v = 0; v < mesh.positions.size(); ++v) {
        const glm::vec3 p = mesh.positions[v], n = mesh.normals[v];
        const glm::vec2 uv = mesh.uvs[v];
        const CornerKey key = {bitsOf(p.x), bitsOf(p.y), bitsOf(p.z),  bitsOf(n.x),
                               bitsOf(n.y), bitsOf(n.z), bitsOf(uv.x), bitsOf(uv.y)};
        representative[v] = first.try_emplace(key, v).first->second;
    }
    return representative;
}

struct UvGradient {
    glm::vec3 alongU{0};
    int orientation = 0;  // sign of the area in uv; 0: none
};

UvGradient uvGradient(const TangentInput& mesh, glm::uvec3 t) {
    const glm::vec3 e1 = mesh.positions[t[1]] - mesh.positions[t[0]];
    const glm::vec3 e2 = mesh.positions[t[2]] - mesh.positions[t[0]];
    const glm::dvec2 d1 = glm::dvec2(mesh.uvs[t[1]]) - glm::dvec2(mesh.uvs[t[0]]);
    const glm::dvec2 d2 = glm::dvec2(mesh.uvs[t[2]]) - glm::dvec2(mesh.uvs[t[0]]);
    const double area = d1.x * d2.y - d1.y * d2.x;
    const double sign = area < 0 ? -1.0 : 1.0;
    const glm::dvec3 alongU = sign * (d2.y * glm::dvec3(e1) - d1.y * glm::dvec3(e2));
    const double length = glm::length(alongU);
    if (area == 0 || !(length > 0)) return {};
    return {glm::vec3(alongU / length), area < 0 ? -1 : 1};
}

// `v` without its part along the unit normal; zero when nothing is left.
glm::vec3 intoPlane(glm::vec3 v, glm::vec3 normal) {
    const glm::vec3 inPlane = v - glm::dot(v, normal) * normal;
    const float length = glm::length(inPlane);
    return length > 1e-6f * glm::length(v) ? inPlane / length : glm::vec3(0);
}

float cornerAngle(const TangentInput& mesh, glm::uvec3 t, int corner) {
    const glm::vec3 p = mesh.positions[t[corner]], normal = mesh.normals[t[corner]];
    const glm::vec3 a = intoPlane(mesh.positions[t[(corner + 1) % 3]] - p, normal);
    const glm::vec3 b = intoPlane(mesh.positions[t[(corner + 2) % 3]] - p, normal);
    return std::acos(glm::clamp(glm::dot(a, b), -1.0f, 1.0f));
}

}  // namespace

glm::vec4 anyTangent(glm::vec3 normal) {
    return {frameFromNormal(normal).tangent, 1};
}

TangentOutput generateTangents(const TangentInput& mesh, std::vector<glm::uvec3>& triangles) {
    const size_t vertexCount = mesh.positions.size();
    const std::vector<uint32_t> representative = weld(mesh);

    // [0]: triangles with negative area in uv (not mirrored in glTF, whose v grows downward), [1]: positive.
    std::array<std::vector<glm::vec3>, 2> sums;
    for (auto& sum : sums) sum.resize(vertexCount, glm::vec3(0));
    std::vector<uint8_t> sides(vertexCount,
                               0);  // bit 0 and 1: which of the two a vertex itself takes part in
    std::vector<int8_t> orientation(triangles.size());
    for (size_t i = 0; i < triangles.size(); ++i) {
        const UvGradient gradient = uvGradient(mesh, triangles[i]);
        orientation[i] = int8_t(gradient.orientation);
        if (gradient.orientation == 0) continue;
        const int side = gradient.orientation > 0;
        for (int corner = 0; corner < 3; ++corner) {
            const uint32_t v = triangles[i][corner];
            sides[v] |= uint8_t(1 << side);
            sums[side][representative[v]] +=
                cornerAngle(mesh, triangles[i], corner) * intoPlane(gradient.alongU, mesh.normals[v]);
        }
    }

    const auto tangent = [&](uint32_t v, int side) {
        const glm::vec3 along = intoPlane(sums[side][representative[v]], mesh.normals[v]);
        if (along == glm::vec3(0)) return anyTangent(mesh.normals[v]);
        return glm::vec4(along, side == 0 ? 1.0f : -1.0f);
    };
    TangentOutput output;
    output.tangents.resize(vertexCount);
    std::vector<uint32_t> mirroredCopy(vertexCount, ~0u);
    for (uint32_t v = 0; v < vertexCount; ++v) {
        output.tangents[v] = tangent(v, sides[v] == 2 ? 1 : 0);
        if (sides[v] != 3) continue;
        mirroredCopy[v] = uint32_t(vertexCount + output.splitFrom.size());
        output.splitFrom.push_back(v);
    }
    for (const uint32_t v : output.splitFrom) output.tangents.push_back(tangent(v, 1));
    for (size_t i = 0; i < triangles.size(); ++i) {
        if (orientation[i] <= 0) continue;
        for (int corner = 0; corner < 3; ++corner) {
            uint32_t& v = triangles[i][corner];
            if (mirroredCopy[v] != ~0u) v = mirroredCopy[v];
        }
    }
    return output;
}

}  // namespace phat::gltf
