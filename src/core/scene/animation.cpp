#include "core/scene/animation.h"

#include <glm/gtc/matrix_transform.hpp>

namespace phat {
namespace {

glm::dquat quatOf(glm::dvec4 v) {
    return glm::dquat(v.w, v.x, v.y, v.z);
}

glm::dvec4 slerp(glm::dvec4 a, glm::dvec4 b, double t) {
    // glm interpolates along the shorter arc, as the specification demands.
    const glm::dquat q = glm::slerp(glm::normalize(quatOf(a)), glm::normalize(quatOf(b)), t);
    return {q.x, q.y, q.z, q.w};
}

glm::dvec4 valueAt(const AnimationChannel& channel, double seconds) {
    const bool spline = channel.interpolation == AnimationChannel::Interpolation::cubicSpline;
    const auto value = [&](size_t key) { return glm::dvec4(channel.values[spline ? 3 * key + 1 : key]); };
    const std::vector<float>& times = channel.times;
    const size_t after = size_t(
        std::upper_bound(times.begin(), times.end(), seconds, [](double s, float time) { return s < time; }) -
        times.begin());
    if (after == 0) return value(0);
    if (after == times.size()) return value(after - 1);
    const size_t before = after - 1;
    if (channel.interpolation == AnimationChannel::Interpolation::step) return value(before);
    const double length = double(times[after]) - times[before];
    const double t = (seconds - times[before]) / length, t2 = t * t, t3 = t2 * t;
    if (spline)  // appendix C.5
        return (2 * t3 - 3 * t2 + 1) * value(before) +
               length * (t3 - 2 * t2 + t) * glm::dvec4(channel.values[3 * before + 2]) +
               (3 * t2 - 2 * t3) * value(after) + length * (t3 - t2) * glm::dvec4(channel.values[3 * after]);
    if (channel.path == AnimationChannel::Path::rotation) return slerp(value(before), value(after), t);
    return glm::mix(value(before), value(after), t);
}

}  // namespace

float Animation::seconds() const {
    float last = 0;
    for (const AnimationChannel& channel : channels)
        if (!channel.times.empty()) last = std::max(last, channel.times.back());
    return last;
}

std::vector<glm::dmat4> worldFromNodes(const std::vector<SceneNode>& nodes, const Animation* animation,
                                       double seconds) {
    struct Local {
        glm::dvec3 translation, scale;
        glm::dquat rotation;
    };
    std::vector<Local> local;
    for (const SceneNode& node : nodes)
        local.push_back({glm::dvec3(node.translation), glm::dvec3(node.scale), glm::dquat(node.rotation)});
    if (animation)
        for (const AnimationChannel& channel : animation->channels) {
            const glm::dvec4 value = valueAt(channel, seconds);
            Local& target = local[channel.node];
            switch (channel.path) {
                case AnimationChannel::Path::translation:
                    target.translation = glm::dvec3(value);
                    break;
                case AnimationChannel::Path::scale:
                    target.scale = glm::dvec3(value);
                    break;
                case AnimationChannel::Path::rotation: {
                    const double length = glm::length(value);
                    if (length > 1e-12) target.rotation = quatOf(value / length);
                    break;
                }
            }
        }
    std::vector<glm::dmat4> world(nodes.size());
    std::vector<uint8_t> known(nodes.size(), 0);
    std::vector<uint32_t> chain;
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        chain.clear();
        for (int32_t n = int32_t(i); n >= 0 && !known[size_t(n)]; n = nodes[size_t(n)].parent)
            chain.push_back(uint32_t(n));
        for (; !chain.empty(); chain.pop_back()) {
            const uint32_t n = chain.back();
            const SceneNode& node = nodes[n];
            const Local& l = local[n];
            const glm::dmat4 parentFromNode =
                node.hasMatrix
                    ? glm::dmat4(node.matrix)
                    : glm::scale(glm::translate(glm::dmat4(1), l.translation) * glm::mat4_cast(l.rotation),
                                 l.scale);
            world[n] = node.parent >= 0 ? world[size_t(node.parent)] * parentFromNode : parentFromNode;
            known[n] = 1;
        }
    }
    return world;
}

std::vector<glm::mat4> worldFromRest(const std::vector<SceneNode>& nodes, const Animation& animation,
                                     double seconds) {
    const std::vector<glm::dmat4> rest = worldFromNodes(nodes, nullptr, 0);
    const std::vector<glm::dmat4> now = worldFromNodes(nodes, &animation, seconds);
    std::vector<glm::mat4> moved(nodes.size(), glm::mat4(1));
    for (size_t i = 0; i < nodes.size(); ++i)
        // A node without volume cannot be moved from where it is.
        if (now[i] != rest[i] && std::abs(glm::determinant(glm::dmat3(rest[i]))) > 1e-30)
            moved[i] = glm::mat4(now[i] * glm::inverse(rest[i]));
    return moved;
}

}  // namespace phat
