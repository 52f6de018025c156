#pragma once
// Tangent frames for normal maps.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace phat::gltf {

/// A mesh whose corners get tangents. The vectors have one element a vertex.
struct TangentInput {
    const std::vector<glm::vec3>& positions;
    const std::vector<glm::vec3>& normals;
    const std::vector<glm::vec2>& uvs;  // as the normal map is looked up, texture transform included
};

struct TangentOutput {
    std::vector<glm::vec4> tangents;  // one a vertex; the split ones follow the old ones
    std::vector<uint32_t> splitFrom;  // old vertex of each vertex that was added
};

/// Tangents along growing u, averaged by corner angle in the plane of the vertex normal over all corners that
/// share position, normal, uv and handedness; w * cross(normal, tangent) points along falling v, glTF's "up"
/// of a normal map. Vertices between mirrored and unmirrored triangles are split, and `triangles` is made to
/// use the copies. Triangles without area in uv take part with their neighbours' tangents.
/// source: what MikkTSpace does (Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited"), which the glTF
///         specification (section 3.7.2.1) asks for; here vertices are welded by exact equality only.
TangentOutput generateTangents(const TangentInput& mesh, std::vector<glm::uvec3>& triangles);

/// Any unit vector orthogonal to the unit normal, with w = 1.
glm::vec4 anyTangent(glm::vec3 normal);

}  // namespace phat::gltf
