#include "viewer/navigation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace phat {
namespace {

Navigation looking(glm::vec3 eye, glm::vec3 target) {
    Camera camera;
    camera.worldFromCamera = glm::inverse(glm::lookAt(eye, target, {0, 1, 0}));
    return navigationOf(camera, glm::distance(eye, target), 1);
}

void expectNear(glm::vec3 a, glm::vec3 b, float tolerance = 1e-4f) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

// Pixels of a window 100 high, from its middle, y down.
glm::vec2 seenAt(const Navigation& n, glm::vec3 point) {
    const glm::vec4 p = glm::inverse(n.camera.worldFromCamera) * glm::vec4(point, 1);
    const float half = n.camera.perspective ? -p.z * std::tan(0.5f * n.camera.yfovRadians) : n.camera.ymag;
    return 50.0f * glm::vec2(p.x, -p.y) / half;
}

TEST(Navigation, OrbitsByHalfACircleOverTheHeight) {
    Navigation n = looking({0, 1, 5}, {0, 1, 0});
    orbit(n, {50, 0}, 100);  // to the right: the front side comes from the left
    expectNear(eyeOf(n), {-5, 1, 0});
    expectNear(focusOf(n), {0, 1, 0});
    orbit(n, {150, 0}, 100);
    expectNear(eyeOf(n), {0, 1, 5});
}

TEST(Navigation, NeverTipsOverThePole) {
    Navigation n = looking({0, 1, 5}, {0, 1, 0});
    for (int i = 0; i < 100; ++i) orbit(n, {3, 40}, 100);
    EXPECT_LT(eyeOf(n).y, 6.0f);
    EXPECT_GT(eyeOf(n).y, 1 + 5 * std::sin(glm::radians(88.0f)));
    EXPECT_GT(glm::vec3(n.camera.worldFromCamera[1]).y, 0);
    expectNear(focusOf(n), {0, 1, 0}, 1e-3f);
}

TEST(Navigation, StaysOrthonormalOverManyTurns) {
    Navigation n = looking({3, 2, 5}, {0, 1, 0});
    for (int i = 0; i < 100'000; ++i) orbit(n, {float(i % 7) - 2.9f, float(i % 5) - 2}, 100);
    const glm::mat3 m(n.camera.worldFromCamera);
    EXPECT_NEAR(glm::determinant(m), 1, 1e-5f);
    EXPECT_NEAR(glm::dot(m[0], m[1]), 0, 1e-5f);
    EXPECT_NEAR(m[0].y, 0, 1e-3f);  // no roll creeps in
}

TEST(Navigation, LooksAroundFromWhereItIs) {
    Navigation n = looking({0, 1, 5}, {0, 1, 0});
    look(n, {50, 0}, 100);  // a quarter to the right
    expectNear(eyeOf(n), {0, 1, 5});
    expectNear(focusOf(n), {5, 1, 5});
}

TEST(Navigation, PanKeepsTheFocusUnderTheMouse) {
    for (const bool perspective : {true, false}) {
        Navigation n = looking({0, 1, 5}, {0, 1, 0});
        n.camera.perspective = perspective;
        pan(n, {10, -20}, 100);
        const glm::vec2 seen = seenAt(n, {0, 1, 0});
        EXPECT_NEAR(seen.x, 10, 1e-3f);
        EXPECT_NEAR(seen.y, -20, 1e-3f);
    }
}

TEST(Navigation, ZoomComesNearerAndNeverArrives) {
    Navigation n = looking({0, 1, 5}, {0, 1, 0});
    zoom(n, 1);
    expectNear(eyeOf(n), {0, 1, 4.5f});
    zoom(n, -1);
    expectNear(eyeOf(n), {0, 1, 5});
    zoom(n, 1000);
    EXPECT_GT(eyeOf(n).z, 0);
}

// In a scene of millimetres the wheel must come as near as in one of metres.
TEST(Navigation, ZoomComesAsNearInEveryUnit) {
    for (const float unit : {1.0f, 1000.0f, 0.001f}) {
        Camera camera;
        camera.worldFromCamera =
            glm::inverse(glm::lookAt(unit * glm::vec3(0, 0, 5), glm::vec3(0), {0, 1, 0}));
        Navigation n = navigationOf(camera, 5 * unit, unit);
        zoom(n, 1000);
        EXPECT_NEAR(n.focusMeters / unit, 1e-3f, 1e-6f) << unit;
    }
}

TEST(Navigation, FramesWhatItIsGiven) {
    Bounds bounds;
    bounds.add({2, 0, 0});
    bounds.add({4, 1, 1});
    for (const float aspect : {0.5f, 2.0f}) {
        Navigation n = looking({0, 1, 5}, {0, 1, 0});
        frameBounds(n, bounds, aspect);
        for (int corner = 0; corner < 8; ++corner) {
            const glm::vec3 p(corner & 1 ? 2 : 4, corner & 2 ? 0 : 1, corner & 4 ? 0 : 1);
            const glm::vec2 seen = glm::abs(seenAt(n, p));
            EXPECT_LE(seen.x, 50 * aspect);
            EXPECT_LE(seen.y, 50);
        }
        expectNear(focusOf(n), bounds.center());
    }
}

}  // namespace
}  // namespace phat
