#include "core/scene/animation.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

namespace phat {
namespace {

using Path = AnimationChannel::Path;
using Interpolation = AnimationChannel::Interpolation;

Animation oneChannel(Path path, Interpolation interpolation, std::vector<float> times,
                     std::vector<glm::vec4> values) {
    return {"a", {{0, path, interpolation, std::move(times), std::move(values)}}};
}

glm::vec3 translationAt(const Animation& animation, double seconds) {
    return glm::vec3(worldFromNodes({SceneNode{}}, &animation, seconds)[0][3]);
}

TEST(Animation, LinearAndStepBetweenKeysAndBeyond) {
    const std::vector<float> times = {1, 2, 4};
    const std::vector<glm::vec4> values = {{0, 0, 0, 0}, {1, 2, 3, 0}, {5, 2, 3, 0}};
    const Animation linear = oneChannel(Path::translation, Interpolation::linear, times, values);
    const Animation step = oneChannel(Path::translation, Interpolation::step, times, values);
    EXPECT_EQ(linear.seconds(), 4);
    EXPECT_EQ(translationAt(linear, 0), glm::vec3(0));
    EXPECT_EQ(translationAt(linear, 1.5), glm::vec3(0.5f, 1, 1.5f));
    EXPECT_EQ(translationAt(linear, 3.5), glm::vec3(4, 2, 3));
    EXPECT_EQ(translationAt(linear, 9), glm::vec3(5, 2, 3));
    EXPECT_EQ(translationAt(step, 1.99), glm::vec3(0));
    EXPECT_EQ(translationAt(step, 2), glm::vec3(1, 2, 3));
    EXPECT_EQ(translationAt(step, 3.9), glm::vec3(1, 2, 3));
}

// A cubic with the tangents of x^3: the spline is it.
TEST(Animation, CubicSplineIsExactForCubics) {
    const auto key = [](float x) {
        const float slope = 3 * x * x;
        return std::array<glm::vec4, 3>{glm::vec4(slope), glm::vec4(x * x * x), glm::vec4(slope)};
    };
    std::vector<glm::vec4> values;
    for (const float x : {-1.0f, 0.5f, 2.0f})
        for (const glm::vec4 value : key(x)) values.push_back(value);
    const Animation spline = oneChannel(Path::translation, Interpolation::cubicSpline, {-1, 0.5f, 2}, values);
    for (const double x : {-1.0, -0.4, 0.0, 0.5, 1.1, 2.0})
        EXPECT_NEAR(translationAt(spline, x).y, x * x * x, 1e-5) << x;
}

TEST(Animation, RotationsTakeTheShorterWay) {
    // The same turns with the other sign are the same rotations.
    const float half = std::sqrt(0.5f);
    const Animation turn = oneChannel(Path::rotation, Interpolation::linear, {0, 1},
                                      {{0, 0, 0, 1}, {0, -half, 0, -half}});  // 90 degrees about y
    const glm::dmat4 middle = worldFromNodes({SceneNode{}}, &turn, 0.5)[0];
    const glm::dvec4 x = middle * glm::dvec4(1, 0, 0, 0);
    EXPECT_NEAR(x.x, half, 1e-6);
    EXPECT_NEAR(x.z, -half, 1e-6);
}

// Children follow, whatever the order of the nodes; one with a matrix is not moved by itself.
TEST(Animation, ChildrenFollowTheirParents) {
    std::vector<SceneNode> nodes(3);
    nodes[0].parent = 2;
    nodes[0].translation = {0, 1, 0};
    nodes[1].parent = 0;
    nodes[1].hasMatrix = true;
    nodes[1].matrix = glm::translate(glm::mat4(1), {0, 0, 3});
    nodes[2].scale = glm::vec3(2);
    Animation animation =
        oneChannel(Path::translation, Interpolation::linear, {0, 1}, {{0, 0, 0, 0}, {4, 0, 0, 0}});
    animation.channels[0].node = 2;
    const std::vector<glm::dmat4> rest = worldFromNodes(nodes, nullptr, 0);
    EXPECT_EQ(glm::dvec3(rest[1][3]), glm::dvec3(0, 2, 6));
    const std::vector<glm::mat4> moved = worldFromRest(nodes, animation, 0.5);
    for (const glm::mat4& m : moved) {
        EXPECT_NEAR(glm::distance(glm::vec3(m * glm::vec4(1, 2, 3, 1)), glm::vec3(3, 2, 3)), 0, 1e-5);
    }
    EXPECT_EQ(worldFromRest(nodes, animation, 0)[1], glm::mat4(1));
}

}  // namespace
}  // namespace phat
