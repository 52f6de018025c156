// Normals that contradict their triangles.

#include <gtest/gtest.h>

#include "io/gltf/gltf_built.h"

namespace phat {
namespace {

using test::GltfBuilder;

// Two triangles in the xy plane, fronts toward +z, with a normal of z = `z[i]` at each corner.
LoadedScene withNormals(const std::vector<float>& z) {
    GltfBuilder builder;
    std::vector<float> normals;
    for (const float each : z) normals.insert(normals.end(), {0, 0, each});
    const int positions = builder.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
    builder.root(
        {{"mesh", builder.mesh({{"attributes",
                                 {{"POSITION", positions}, {"NORMAL", builder.floats("VEC3", normals)}}}})}});
    return test::load(builder);
}

TEST(GltfNormals, OfAMeshTurnedInsideOutAreTurned) {
    const LoadedScene loaded = withNormals({-1, -1, -1, -1, -1, -1});
    ASSERT_EQ(loaded.scene.normals.size(), 6u);
    for (const glm::vec3& normal : loaded.scene.normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
    ASSERT_EQ(loaded.notes.size(), 1u);
    EXPECT_EQ(loaded.notes[0].substr(0, 23), "1 primitive has normals");
}

TEST(GltfNormals, ThatContradictSomeTrianglesStay) {
    const std::vector<float> z = {-1, -1, -1, 1, 1, 1};
    const LoadedScene loaded = withNormals(z);
    ASSERT_EQ(loaded.scene.normals.size(), 6u);
    for (size_t i = 0; i < z.size(); ++i) EXPECT_EQ(loaded.scene.normals[i], glm::vec3(0, 0, z[i]));
    EXPECT_TRUE(loaded.notes.empty());
}

}  // namespace
}  // namespace phat
