#pragma once
// Moving parts of a scene rigidly: where nodes are, against where they are at rest.

#include <span>
#include <vector>

#include "core/scene/scene.h"

namespace phat {

/// A motion of a node and all below it, by hand. In world space: it comes after the file's own animation.
struct NodeMotion {
    uint32_t node = 0;     // glTF index
    glm::vec3 pivot{0};    // centre of rotation, world, before the motion
    glm::vec3 meters{0};   // by which the pivot moves
    glm::vec3 degrees{0};  // about x, then y, then z

    bool operator==(const NodeMotion&) const = default;
};

/// The motion as a matrix, without those of the nodes above.
glm::mat4 matrixOf(const NodeMotion& motion);
/// The motion about the same pivot that a rigid matrix is.
NodeMotion motionOf(uint32_t node, glm::vec3 pivot, const glm::mat4& matrix);

/// `worldFromRest` [glTF node], empty: at rest, with the motions on top.
std::vector<glm::mat4> withMotions(const std::vector<SceneNode>& nodes, std::vector<glm::mat4> worldFromRest,
                                   std::span<const NodeMotion> motions);
/// The motions of all nodes above, on top of which `node`'s own is made.
glm::mat4 motionAbove(const std::vector<SceneNode>& nodes, std::span<const NodeMotion> motions,
                      uint32_t node);

/// The node's own motion, added without effect when there is none: it turns around the node's middle at rest.
NodeMotion& motionFor(std::vector<NodeMotion>& motions, const Scene& rest, uint32_t node);
/// Box around the surfaces of a node.
Bounds boundsOfNode(const Scene& scene, uint32_t node);

/// Of nodes beyond the end: identity.
inline glm::mat4 matrixAt(std::span<const glm::mat4> worldFromRest, uint32_t node) {
    return node < worldFromRest.size() ? worldFromRest[node] : glm::mat4(1);
}

inline glm::vec3 movedPoint(const glm::mat4& m, glm::vec3 p) {
    return glm::vec3(m * glm::vec4(p, 1.0f));
}

/// For normals, also of a flattened or mirrored node; lengths change.
glm::mat3 normalMatrix(const glm::mat4& m);

/// The lights that are at `rest` where their nodes carry them.
std::vector<PunctualLight> movedLights(std::vector<PunctualLight> rest,
                                       std::span<const glm::mat4> worldFromRest);

/// Moves the surfaces of `scene`, which is `rest` moved by `before`, to `now`; where that is the identity,
/// exactly to where they are at rest. Returns whether any has moved.
bool moveSurfaces(const Scene& rest, std::span<const glm::mat4> before, std::span<const glm::mat4> now,
                  Scene& scene);

}  // namespace phat
