#include "core/scene/scene_motion.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>

namespace phat {
namespace {

glm::quat turnOf(glm::vec3 degrees) {
    const auto about = [&](int axis) {
        glm::vec3 direction(0);
        direction[axis] = 1;
        return glm::angleAxis(glm::radians(degrees[axis]), direction);
    };
    return about(2) * about(1) * about(0);
}

// Of R = Rz Ry Rx. Where y is a quarter turn, x and z turn about the same axis and x is 0.
glm::vec3 degreesOf(const glm::mat3& r) {
    const float sinY = std::clamp(-r[0][2], -1.0f, 1.0f);
    const glm::vec3 radians =
        std::abs(sinY) < 0.999999f
            ? glm::vec3(std::atan2(r[1][2], r[2][2]), std::asin(sinY), std::atan2(r[0][1], r[0][0]))
            : glm::vec3(0, std::asin(sinY), std::atan2(-r[1][0], r[1][1]));
    return glm::degrees(radians);
}

const NodeMotion* motionAt(std::span<const NodeMotion> motions, uint32_t node) {
    const auto found = std::find_if(motions.begin(), motions.end(),
                                    [&](const NodeMotion& motion) { return motion.node == node; });
    return found == motions.end() ? nullptr : &*found;
}

// Puts a surface's vertices where `m` takes those at rest.
void moveSurface(const Scene& rest, const Surface& surface, const glm::mat4& m, Scene& scene) {
    if (m == glm::mat4(1)) {
        const auto restore = [&](auto& values, const auto& from) {
            std::copy_n(from.begin() + surface.firstVertex, surface.vertexCount,
                        values.begin() + surface.firstVertex);
        };
        restore(scene.positions, rest.positions);
        restore(scene.normals, rest.normals);
        restore(scene.tangents, rest.tangents);
        return;
    }
    const glm::mat3 normals = normalMatrix(m), linear(m);
    for (uint32_t v = surface.firstVertex; v < surface.firstVertex + surface.vertexCount; ++v) {
        scene.positions[v] = movedPoint(m, rest.positions[v]);
        scene.normals[v] = glm::normalize(normals * rest.normals[v]);
        if (const glm::vec4 tangent = rest.tangents[v]; tangent != glm::vec4(0))
            scene.tangents[v] = glm::vec4(glm::normalize(linear * glm::vec3(tangent)), tangent.w);
    }
}

}  // namespace

glm::mat4 matrixOf(const NodeMotion& motion) {
    glm::mat4 m = glm::mat4_cast(turnOf(motion.degrees));
    m[3] = glm::vec4(motion.meters + motion.pivot - glm::mat3(m) * motion.pivot, 1.0f);
    return m;
}

NodeMotion motionOf(uint32_t node, glm::vec3 pivot, const glm::mat4& matrix) {
    return {node, pivot, movedPoint(matrix, pivot) - pivot, degreesOf(glm::mat3(matrix))};
}

glm::mat4 motionAbove(const std::vector<SceneNode>& nodes, std::span<const NodeMotion> motions,
                      uint32_t node) {
    glm::mat4 above(1);
    for (int32_t n = nodes[node].parent; n >= 0; n = nodes[size_t(n)].parent)
        if (const NodeMotion* motion = motionAt(motions, uint32_t(n))) above = matrixOf(*motion) * above;
    return above;
}

std::vector<glm::mat4> withMotions(const std::vector<SceneNode>& nodes, std::vector<glm::mat4> worldFromRest,
                                   std::span<const NodeMotion> motions) {
    if (motions.empty()) return worldFromRest;
    worldFromRest.resize(nodes.size(), glm::mat4(1));
    for (uint32_t n = 0; n < nodes.size(); ++n) {
        glm::mat4 motion = motionAbove(nodes, motions, n);
        if (const NodeMotion* own = motionAt(motions, n)) motion = motion * matrixOf(*own);
        worldFromRest[n] = motion * worldFromRest[n];
    }
    return worldFromRest;
}

Bounds boundsOfNode(const Scene& scene, uint32_t node) {
    Bounds bounds;
    for (const Surface& surface : scene.surfaces)
        for (uint32_t v = 0; v < surface.vertexCount && surface.node == node; ++v)
            bounds.add(scene.positions[surface.firstVertex + v]);
    return bounds;
}

NodeMotion& motionFor(std::vector<NodeMotion>& motions, const Scene& rest, uint32_t node) {
    for (NodeMotion& motion : motions)
        if (motion.node == node) return motion;
    const Bounds bounds = boundsOfNode(rest, node);
    return motions.emplace_back(NodeMotion{node, bounds.empty() ? glm::vec3(0) : bounds.center(), {}, {}});
}

glm::mat3 normalMatrix(const glm::mat4& m) {
    const glm::mat3 linear(m);
    const glm::mat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                              glm::cross(linear[0], linear[1]));
    return glm::determinant(linear) < 0 ? -cofactors : cofactors;
}

std::vector<PunctualLight> movedLights(std::vector<PunctualLight> rest,
                                       std::span<const glm::mat4> worldFromRest) {
    for (PunctualLight& light : rest) {
        const glm::mat4 m = matrixAt(worldFromRest, light.node);
        if (m == glm::mat4(1)) continue;
        light.position = movedPoint(m, light.position);
        light.direction = glm::normalize(glm::mat3(m) * light.direction);
        light.horizontalZero =
            frameFromNormalAndTangent(-light.direction, glm::mat3(m) * light.horizontalZero).tangent;
    }
    return rest;
}

bool moveSurfaces(const Scene& rest, std::span<const glm::mat4> before, std::span<const glm::mat4> now,
                  Scene& scene) {
    bool any = false;
    for (const Surface& surface : rest.surfaces) {
        const glm::mat4 m = matrixAt(now, surface.node);
        if (m == matrixAt(before, surface.node)) continue;
        moveSurface(rest, surface, m, scene);
        any = true;
    }
    return any;
}

}  // namespace phat
