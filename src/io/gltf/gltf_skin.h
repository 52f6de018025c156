#pragma once
// A mesh that follows its joints (specification, section 3.7.3.3).

#include <glm/glm.hpp>
#include <vector>

#include "io/gltf/gltf_problem.h"
#include "io/gltf/gltf_source.h"

namespace phat::gltf {

// What deforms: each a vector per vertex, empty where the primitive has none.
struct Geometry {
    std::vector<float> positions, normals, tangents;

    std::vector<float>* of(const std::string& name) {
        if (name == "POSITION") return &positions;
        if (name == "NORMAL") return &normals;
        return name == "TANGENT" ? &tangents : nullptr;
    }
};
/// The matrix of each vertex by the joints and weights of a primitive, four of each a set. Weights are
/// normalised: quantised ones add up to one only nearly.
std::vector<glm::dmat4> blendedMatrices(const GltfSource& source, const nlohmann::json& attributes,
                                        uint64_t count, const std::vector<glm::dmat4>& joints);

void skinGeometry(const std::vector<glm::dmat4>& matrices, Geometry& geometry);

/// Swaps two corners of the triangles that their joints mirror, so that fronts stay on the normals' side. The
/// specification (section 3.7.4) takes the winding from the transform of the mesh's node, which is void for
/// skins; where all of a figure is mirrored, joints and node say the same. Renderers that ask the node alone
/// show a figure with one mirrored joint partly inside out.
void turnMirrored(GltfSource& source, nlohmann::json& primitive, const std::vector<glm::dmat4>& matrices,
                  MemoryBudget& budget);

}  // namespace phat::gltf
