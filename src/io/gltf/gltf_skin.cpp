#include "io/gltf/gltf_skin.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/gltf/gltf_json.h"

namespace phat::gltf {

using nlohmann::json;

std::vector<glm::dmat4> blendedMatrices(const GltfSource& source, const json& attributes, uint64_t count,
                                        const std::vector<glm::dmat4>& joints) {
    std::vector<glm::dmat4> blended(count, glm::dmat4(0.0));
    std::vector<double> sums(count, 0.0);
    for (int set = 0; attributes.contains(fmt::format("JOINTS_{}", set)); ++set) {
        const std::string jointName = fmt::format("JOINTS_{}", set),
                          weightName = fmt::format("WEIGHTS_{}", set);
        const auto indices =
            accessorFloats(source, wholeNumber(attributes, jointName.c_str()), 4, false, count);
        const auto weights =
            accessorFloats(source, wholeNumber(attributes, weightName.c_str()), 4, true, count);
        for (size_t i = 0; i < count * 4; ++i) {
            if (!(weights[i] > 0) || !std::isfinite(weights[i])) continue;
            if (!(indices[i] >= 0 && size_t(indices[i]) < joints.size()))
                throw Problem(fmt::format("joint {} of {} does not exist", indices[i], joints.size()));
            blended[i / 4] += double(weights[i]) * joints[size_t(indices[i])];
            sums[i / 4] += double(weights[i]);
        }
    }
    for (size_t v = 0; v < count; ++v)
        blended[v] = sums[v] > 0 ? blended[v] / sums[v] : joints.empty() ? glm::dmat4(1.0) : joints[0];
    return blended;
}

void skinGeometry(const std::vector<glm::dmat4>& matrices, Geometry& geometry) {
    const auto write = [](std::vector<float>& to, size_t at, glm::dvec3 value) {
        for (int c = 0; c < 3; ++c) to[at + size_t(c)] = float(value[c]);
    };
    const auto read = [](const std::vector<float>& from, size_t at) {
        return glm::dvec3(from[at], from[at + 1], from[at + 2]);
    };
    for (size_t v = 0; v < matrices.size(); ++v) {
        const glm::dmat4& m = matrices[v];
        const glm::dmat3 linear(m);
        write(geometry.positions, 3 * v, m * glm::dvec4(read(geometry.positions, 3 * v), 1.0));
        if (!geometry.normals.empty()) {
            // The cofactors: the inverse transpose up to a factor, defined for flattened joints too.
            const glm::dmat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                                       glm::cross(linear[0], linear[1]));
            const double sign = glm::determinant(linear) < 0 ? -1.0 : 1.0;
            const glm::dvec3 normal = sign * (cofactors * read(geometry.normals, 3 * v));
            const double length = glm::length(normal);
            write(geometry.normals, 3 * v, length > 0 && std::isfinite(length) ? normal / length : normal);
        }
        if (!geometry.tangents.empty()) {
            write(geometry.tangents, 4 * v, linear * read(geometry.tangents, 4 * v));
            // cross(normal, tangent) does not follow a mirror.
            if (glm::determinant(linear) < 0) geometry.tangents[4 * v + 3] *= -1;
        }
    }
}

void turnMirrored(GltfSource& source, json& primitive, const std::vector<glm::dmat4>& matrices,
                  MemoryBudget& budget) {
    constexpr uint64_t kTriangleList = 4;  // and above it strips and fans
    if (wholeNumber(primitive, "mode", kTriangleList) < kTriangleList) return;
    std::vector<double> sign(matrices.size());
    std::transform(matrices.begin(), matrices.end(), sign.begin(), [](const glm::dmat4& m) {
        const double determinant = glm::determinant(glm::dmat3(m));
        return double((determinant > 0) - (determinant < 0));
    });
    if (std::none_of(sign.begin(), sign.end(), [](double s) { return s < 0; })) return;
    uint64_t listed = matrices.size();
    if (primitive.contains("indices"))
        listed = wholeNumber(gltfItem(source.json, "accessors", wholeNumber(primitive, "indices")), "count");
    // A strip has a triangle for every index: read, listed, and written.
    constexpr uint64_t kIndexBytes = 4 + 4 + 12 + 12;
    if (listed > budget.left() / kIndexBytes) budget.charge(~0ull, "its posed meshes");
    budget.charge(listed * kIndexBytes, "its posed meshes");
    auto triangles = primitiveTriangles(source, primitive, uint32_t(matrices.size()));
    for (auto& [a, b, c] : triangles)
        if (sign[a] + sign[b] + sign[c] < 0) std::swap(b, c);
    primitive["indices"] =
        addIndices(source, {reinterpret_cast<const uint32_t*>(triangles.data()), 3 * triangles.size()});
    primitive.erase("mode");
}

}  // namespace phat::gltf
