#pragma once
// One glTF primitive as indexed triangles, in its node's space.

#include "core/scene/scene.h"
#include "io/gltf/gltf_document.h"

namespace phat::gltf {

struct MeshPart {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;   // not necessarily unit
    std::vector<glm::vec4> tangents;  // all zero where the material needs none
    std::vector<glm::vec2> uv0;
    std::vector<glm::vec2> uv1;
    std::vector<glm::vec4> colors;
    std::vector<glm::uvec3> triangles;
};

/// How large a primitive gets, without decoding it; exact but for vertices that generated tangents split.
struct PartSize {
    uint64_t vertices = 0;
    uint64_t triangles = 0;
    uint64_t bytes() const;
};
PartSize partSize(const tinygltf::Model& model, const tinygltf::Primitive& primitive);

/// Whether there are triangles to draw; counts in `notes` what is skipped.
bool hasTriangles(const tinygltf::Primitive& primitive, Notes& notes);

/// Decodes strips and fans too. Without normals the triangles are flat and own their vertices; without
/// tangents, materials with normal maps get generated ones. Throws Problem.
MeshPart readPart(const Document& document, const tinygltf::Primitive& primitive, const Material& material,
                  Notes& notes);

}  // namespace phat::gltf
