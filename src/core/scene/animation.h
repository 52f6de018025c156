#pragma once
// Motion of a scene's nodes, as glTF has it (specification, section 3.11 and appendix C).

#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <vector>

#include "core/base/math.h"

namespace phat {

/// A node at rest.
struct SceneNode {
    std::string name;
    int32_t parent = -1;
    bool hasMatrix = false;  // then `matrix` is it, and it cannot be animated
    glm::mat4 matrix{1};
    glm::vec3 translation{0};
    glm::quat rotation{1, 0, 0, 0};  // unit
    glm::vec3 scale{1};
};

struct AnimationChannel {
    enum class Path : uint8_t { translation, rotation, scale };
    enum class Interpolation : uint8_t { linear, step, cubicSpline };
    uint32_t node = 0;
    Path path = Path::translation;
    Interpolation interpolation = Interpolation::linear;
    std::vector<float> times;  // seconds, growing
    std::vector<glm::vec4>
        values;  // a key each; of splines in-tangent, value, out-tangent. Rotations: x y z w
};

struct Animation {
    std::string name;
    std::vector<AnimationChannel> channels;

    /// The last key's time.
    float seconds() const;
};

/// World from each node. `animation` null: at rest. Before the first key and after the last the pose stays.
std::vector<glm::dmat4> worldFromNodes(const std::vector<SceneNode>& nodes, const Animation* animation,
                                       double seconds);

/// Transforms of the nodes relative to their rest pose: SceneState::worldFromRest.
std::vector<glm::mat4> worldFromRest(const std::vector<SceneNode>& nodes, const Animation& animation,
                                     double seconds);

}  // namespace phat
