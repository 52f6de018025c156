#include "io/gltf/gltf_tangents.h"

#include <gtest/gtest.h>

#include <cmath>

namespace phat::gltf {
namespace {

struct Quad {
    std::vector<glm::vec3> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    std::vector<glm::vec3> normals{4, glm::vec3(0, 0, 1)};
    // glTF's v grows downward: the picture stands upright.
    std::vector<glm::vec2> uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    std::vector<glm::uvec3> triangles = {{0, 1, 2}, {0, 2, 3}};

    TangentOutput generate() { return generateTangents({positions, normals, uvs}, triangles); }
};

glm::vec3 bitangent(const Quad& mesh, const TangentOutput& output, size_t vertex) {
    const glm::vec4 t = output.tangents[vertex];
    return t.w * glm::cross(mesh.normals[vertex], glm::vec3(t));
}

TEST(Tangents, UprightPicture) {
    Quad quad;
    const TangentOutput output = quad.generate();
    EXPECT_TRUE(output.splitFrom.empty());
    for (size_t v = 0; v < 4; ++v) {
        EXPECT_NEAR(glm::distance(glm::vec3(output.tangents[v]), glm::vec3(1, 0, 0)), 0, 1e-6f);
        EXPECT_NEAR(glm::distance(bitangent(quad, output, v), glm::vec3(0, 1, 0)), 0, 1e-6f);
    }
}

TEST(Tangents, MirroredPictureFlipsHandedness) {
    Quad quad;
    for (glm::vec2& uv : quad.uvs) uv.x = 1 - uv.x;
    const TangentOutput output = quad.generate();
    for (size_t v = 0; v < 4; ++v) {
        EXPECT_NEAR(glm::distance(output.tangents[v], glm::vec4(-1, 0, 0, -1)), 0, 1e-6f);
        EXPECT_NEAR(glm::distance(bitangent(quad, output, v), glm::vec3(0, 1, 0)), 0, 1e-6f);
    }
}

TEST(Tangents, TurnedAndScaledPicture) {
    Quad quad;
    for (glm::vec2& uv : quad.uvs) uv = glm::vec2(3 * uv.y, -5 * uv.x);
    const TangentOutput output = quad.generate();
    // Now u = 3 * (1 - y) grows along -y and v = -5 x falls along +x.
    EXPECT_NEAR(glm::distance(glm::vec3(output.tangents[0]), glm::vec3(0, -1, 0)), 0, 1e-6f);
    EXPECT_NEAR(glm::distance(bitangent(quad, output, 0), glm::vec3(1, 0, 0)), 0, 1e-6f);
}

// Two quads that mirror each other at x = 1 and share the vertices there.
TEST(Tangents, VerticesOnAMirrorLineAreSplit) {
    Quad quad;
    quad.positions.insert(quad.positions.end(), {{2, 0, 0}, {2, 1, 0}});
    quad.normals.resize(6, glm::vec3(0, 0, 1));
    quad.uvs.insert(quad.uvs.end(), {{0, 1}, {0, 0}});
    quad.triangles.insert(quad.triangles.end(), {{1, 4, 5}, {1, 5, 2}});
    const TangentOutput output = quad.generate();
    EXPECT_EQ(output.splitFrom, (std::vector<uint32_t>{1, 2}));
    ASSERT_EQ(output.tangents.size(), 8u);
    for (size_t t = 0; t < 4; ++t) {
        const float handedness = t < 2 ? 1 : -1;
        for (int corner = 0; corner < 3; ++corner) {
            const glm::vec4 tangent = output.tangents[quad.triangles[t][corner]];
            EXPECT_NEAR(glm::distance(tangent, glm::vec4(handedness, 0, 0, handedness)), 0, 1e-6f) << t;
        }
    }
}

// Vertices that are equal but not shared get the tangents of shared ones.
TEST(Tangents, EqualVerticesAreWelded) {
    const auto curved = [] {
        Quad quad;
        quad.positions[2].z = 0.4f;  // so that the two triangles disagree
        quad.uvs[3] = {0.3f, -0.2f};
        return quad;
    };
    Quad shared = curved();
    const TangentOutput expected = shared.generate();
    Quad loose = curved();
    Quad unshared;
    unshared.positions.clear();
    unshared.uvs.clear();
    unshared.triangles.clear();
    for (const glm::uvec3& t : loose.triangles) {
        const uint32_t first = uint32_t(unshared.positions.size());
        unshared.triangles.push_back({first, first + 1, first + 2});
        for (int corner = 0; corner < 3; ++corner) {
            unshared.positions.push_back(loose.positions[t[corner]]);
            unshared.uvs.push_back(loose.uvs[t[corner]]);
        }
    }
    unshared.normals.assign(6, glm::vec3(0, 0, 1));
    const TangentOutput output = unshared.generate();
    EXPECT_GT(glm::distance(expected.tangents[0], expected.tangents[1]), 0.01f);  // the case is not trivial
    for (size_t t = 0; t < 2; ++t)
        for (int corner = 0; corner < 3; ++corner)
            EXPECT_NEAR(glm::distance(output.tangents[3 * t + size_t(corner)],
                                      expected.tangents[loose.triangles[t][corner]]),
                        0, 1e-6f);
}

// Cutting a triangle in two along an angle must not change what its corner weighs.
TEST(Tangents, WeightsAreAnglesNotTriangles) {
    // A fan of eight triangles with one tangent and one of an equal angle with another, around vertex 0.
    std::vector<glm::vec3> positions = {{0, 0, 0}};
    std::vector<glm::vec2> uvs = {{0, 0}};
    std::vector<glm::uvec3> triangles;
    const auto addFan = [&](float from, int count, bool turned) {
        for (int i = 0; i < count; ++i) {
            const uint32_t first = uint32_t(positions.size());
            for (int k = 0; k < 2; ++k) {
                const float angle = from + 1.5f * float(i + k) / float(count);
                const glm::vec3 p(std::cos(angle), std::sin(angle), 0);
                positions.push_back(p);
                // v = -y keeps both right-handed; the turned half has u along y.
                uvs.push_back(turned ? glm::vec2(p.y, p.x) : glm::vec2(p.x, -p.y));
            }
            triangles.push_back({0, first, first + 1});
        }
    };
    addFan(0, 8, false);
    addFan(3, 1, true);
    const std::vector<glm::vec3> normals(positions.size(), glm::vec3(0, 0, 1));
    for (const float size : {1.0f, 1e-7f}) {  // in any unit
        std::vector<glm::vec3> sized = positions;
        for (glm::vec3& p : sized) p *= size;
        const TangentOutput output = generateTangents({sized, normals, uvs}, triangles);
        EXPECT_NEAR(glm::distance(glm::vec3(output.tangents[0]), glm::normalize(glm::vec3(1, 1, 0))), 0,
                    1e-5f);
    }
}

TEST(Tangents, DegenerateInputStillGivesFrames) {
    Quad quad;
    quad.uvs.assign(4, glm::vec2(0.5f));
    quad.positions[3] = quad.positions[2];
    const TangentOutput output = quad.generate();
    for (size_t v = 0; v < 4; ++v) {
        const glm::vec3 tangent = output.tangents[v];
        EXPECT_NEAR(glm::length(tangent), 1, 1e-6f);
        EXPECT_NEAR(glm::dot(tangent, quad.normals[v]), 0, 1e-6f);
        EXPECT_EQ(std::abs(output.tangents[v].w), 1);
    }
}

}  // namespace
}  // namespace phat::gltf
