#include "io/gltf/material_edit.h"

#include <gtest/gtest.h>

#include <stdexcept>

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

TEST(MaterialEdit, NamesWithEqualsSignsStandInQuotes) {
    std::vector<Material> from(4);
    from[0].name = "a=b";
    from[1].name = "say \"x=1\" \\ or.so";
    from[2].name = "\"";
    from[3].name = "plain.name";
    std::vector<Material> to = from, again = from;
    for (size_t i = 0; i < to.size(); ++i) to[i].roughness = 0.1f * float(i + 1);
    for (const std::string& edit : materialEdits(from, to)) editMaterial(edit, again);
    for (size_t i = 0; i < to.size(); ++i) EXPECT_EQ(again[i].roughness, to[i].roughness) << i;

    editMaterial("\"a=b\".roughness=0.7", again);
    EXPECT_EQ(again[0].roughness, 0.7f);
    editMaterial("\"plain.name\".roughness=0.8", again);  // quotes that are not needed do no harm
    EXPECT_EQ(again[3].roughness, 0.8f);
    for (const char* wrong : {"a=b.roughness=1", "\"a=b.roughness=1", "\"a=b\"roughness=1",
                              "\"a=b\"x.roughness=1", "\"a=b\".roughness"})
        EXPECT_THROW(editMaterial(wrong, again), std::invalid_argument) << wrong;
}

}  // namespace
}  // namespace phat
