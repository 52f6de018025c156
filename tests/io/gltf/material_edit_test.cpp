#include "io/gltf/material_edit.h"

#include <gtest/gtest.h>

namespace phat {
namespace {

TEST(MaterialEdit, SaysWhatTurnsOneIntoAnother) {
    std::vector<Material> from(2);
    from[0].name = "floor";
    from[1].name = "wall.left";
    std::vector<Material> to = from;
    to[0].roughness = 0.1f + 0.2f;
    to[0].baseColor = {1.0f / 3, 0.25f, 1e-7f, 1};
    to[1].normalScale = 0.3f;
    const auto edits = materialEdits(from, to);
    EXPECT_EQ(edits.size(), 3u);
    std::vector<Material> again = from;
    for (const std::string& edit : edits) editMaterial(edit, again);
    EXPECT_EQ(again[0].roughness, to[0].roughness);
    EXPECT_EQ(again[0].baseColor, to[0].baseColor);
    EXPECT_EQ(again[1].normalScale, to[1].normalScale);
    EXPECT_TRUE(materialEdits(to, again).empty());
}

}  // namespace
}  // namespace phat
