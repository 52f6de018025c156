#include "core/atlas/piece_pose.h"

#include <algorithm>
#include <cmath>

namespace phat {

uint32_t PiecePose::turnToward(const glm::dvec3& direction) const {
    uint32_t best = 0;
    for (uint32_t turn = 1; turn < 4; ++turn)
        if (glm::dot(xAfter(turn), direction) > glm::dot(xAfter(best), direction) + 1e-9) best = turn;
    return best;
}

PiecePose poseOf(const Scene& scene, const MeshTopology& topology, const FlatChart& flat) {
    PiecePose pose;
    for (size_t t = 0; t < flat.triangles.size(); ++t) {
        const glm::uvec3& v = scene.triangles[flat.triangles[t]];
        const glm::dvec3 a = scene.positions[v.x], b = scene.positions[v.y], c = scene.positions[v.z];
        const double area = topology.faceArea[flat.triangles[t]];
        pose.center += area / flat.area * (a + b + c) / 3.0;
        pose.normal += area * topology.faceNormal[flat.triangles[t]];
        const auto& uv = flat.uvMeters[t];
        const glm::dmat2 inverse = glm::inverse(glm::dmat2(uv[1] - uv[0], uv[2] - uv[0]));
        pose.tangent += area * (inverse[0][0] * (b - a) + inverse[0][1] * (c - a));
    }
    pose.normal = glm::normalize(pose.normal);
    for (const uint32_t t : flat.triangles)
        pose.lean =
            std::max(pose.lean, std::acos(std::min(glm::dot(topology.faceNormal[t], pose.normal), 1.0)));
    pose.tangent -= glm::dot(pose.tangent, pose.normal) * pose.normal;
    pose.tangent = glm::normalize(pose.tangent);
    pose.bitangent = glm::cross(pose.normal, pose.tangent);
    return pose;
}

glm::dvec2 turnedPosition(glm::dvec2 p, glm::dvec2 size, uint32_t turns) {
    for (uint32_t i = 0; i < turns % 4; ++i) {
        p = {size.y - p.y, p.x};
        size = {size.y, size.x};
    }
    return p;
}

}  // namespace phat
