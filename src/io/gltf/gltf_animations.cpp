#include "io/gltf/gltf_animations.h"

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "io/gltf/gltf_accessor.h"
#include "io/gltf/gltf_lights_cameras.h"

namespace phat::gltf {
namespace {

SceneNode nodeOf(const tinygltf::Node& in) {
    SceneNode node;
    node.name = in.name;
    node.hasMatrix = !in.matrix.empty();
    for (size_t i = 0; i < in.matrix.size(); ++i) node.matrix[int(i / 4)][int(i % 4)] = float(in.matrix[i]);
    if (!in.rotation.empty()) {
        const glm::dquat q(in.rotation[3], in.rotation[0], in.rotation[1], in.rotation[2]);
        const double length = glm::length(q);
        node.rotation = length > 1e-12 ? glm::quat(q / length) : glm::quat(1, 0, 0, 0);
    }
    for (int axis = 0; axis < 3; ++axis) {
        if (!in.scale.empty()) node.scale[axis] = float(in.scale[size_t(axis)]);
        if (!in.translation.empty()) node.translation[axis] = float(in.translation[size_t(axis)]);
    }
    return node;
}

std::optional<AnimationChannel::Path> pathOf(const std::string& name) {
    if (name == "translation") return AnimationChannel::Path::translation;
    if (name == "rotation") return AnimationChannel::Path::rotation;
    if (name == "scale") return AnimationChannel::Path::scale;
    return std::nullopt;
}

std::optional<AnimationChannel::Interpolation> interpolationOf(const std::string& name) {
    if (name.empty() || name == "LINEAR") return AnimationChannel::Interpolation::linear;
    if (name == "STEP") return AnimationChannel::Interpolation::step;
    if (name == "CUBICSPLINE") return AnimationChannel::Interpolation::cubicSpline;
    return std::nullopt;
}

bool hasAccessor(const tinygltf::Model& model, int64_t index, int type) {
    return index >= 0 && index < int64_t(model.accessors.size()) &&
           model.accessors[size_t(index)].type == type;
}

std::optional<AnimationChannel> channelOf(const Document& document, const Scene& scene,
                                          const ChannelEntry& entry, MemoryBudget& budget) {
    const auto& model = document.model();
    const auto path = pathOf(entry.path);
    const auto interpolation = interpolationOf(entry.interpolation);
    if (!path || !interpolation || entry.node < 0 || entry.node >= int64_t(scene.nodes.size()) ||
        scene.nodes[size_t(entry.node)].hasMatrix)
        return std::nullopt;
    const bool rotation = *path == AnimationChannel::Path::rotation;
    if (!hasAccessor(model, entry.input, TINYGLTF_TYPE_SCALAR) ||
        !hasAccessor(model, entry.output, rotation ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3))
        return std::nullopt;
    const auto& output = model.accessors[size_t(entry.output)];
    const size_t keys = model.accessors[size_t(entry.input)].count;
    const size_t perKey = *interpolation == AnimationChannel::Interpolation::cubicSpline ? 3 : 1;
    if (output.count / perKey != keys || output.count % perKey != 0) return std::nullopt;

    budget.charge(uint64_t(keys) * (2 * sizeof(float) + 2 * perKey * sizeof(glm::vec4)), "its animations");
    AnimationChannel channel{uint32_t(entry.node), *path, *interpolation, {}, {}};
    channel.times = readFloats(document, int(entry.input), 1);
    for (size_t i = 0; i < keys; ++i)
        if (!std::isfinite(channel.times[i]) || (i > 0 && channel.times[i] <= channel.times[i - 1]))
            return std::nullopt;
    // Only rotations may be integers, and then they are normalised (specification, section 3.11).
    if (rotation)
        channel.values = readVectors<4>(document, int(entry.output), true);
    else
        for (const glm::vec3 value : readVectors<3>(document, int(entry.output)))
            channel.values.emplace_back(value, 0.0f);
    for (const glm::vec4 value : channel.values)
        for (int c = 0; c < 4; ++c)
            if (!(std::abs(value[c]) <= kMaxCoordinateMeters)) return std::nullopt;
    return channel;
}

}  // namespace

void readAnimations(const Document& document, const std::vector<WorldNode>& shown, Scene& scene,
                    MemoryBudget& budget, Notes& notes) {
    const auto& model = document.model();
    budget.charge(model.nodes.size() * 2 * sizeof(SceneNode), "its nodes");
    for (const tinygltf::Node& node : model.nodes) scene.nodes.push_back(nodeOf(node));
    for (const WorldNode& world : shown)
        for (const int child : model.nodes[world.node].children)
            scene.nodes[size_t(child)].parent = int32_t(world.node);

    size_t leftOut = 0;
    for (size_t i = 0; i < document.description.animations.size(); ++i) {
        const AnimationEntry& entry = document.description.animations[i];
        Animation animation;
        animation.name = entry.name.empty() ? fmt::format("animation {}", i) : entry.name;
        for (const ChannelEntry& channelEntry : entry.channels) {
            if (auto channel = channelOf(document, scene, channelEntry, budget))
                animation.channels.push_back(std::move(*channel));
            else
                ++leftOut;
        }
        if (!animation.channels.empty()) scene.animations.push_back(std::move(animation));
    }
    if (leftOut > 0)
        notes.lines.push_back(fmt::format("{} animation {} no node and {} left out", leftOut,
                                          leftOut == 1 ? "channel moves" : "channels move",
                                          leftOut == 1 ? "is" : "are"));
}

}  // namespace phat::gltf
