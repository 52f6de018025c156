#include "viewer/edit_history.h"

#include <gtest/gtest.h>

namespace phat {
namespace {

SceneEdits rough(float roughness) {
    SceneEdits e;
    e.materials.resize(1);
    e.materials[0].roughness = roughness;
    return e;
}

float now(const EditHistory& history) {
    return history.now().materials[0].roughness;
}

TEST(EditHistory, GoesBackAndForth) {
    EditHistory history(rough(0.1f));
    EXPECT_FALSE(history.canUndo());
    history.change(rough(0.2f), false);
    history.change(rough(0.3f), false);
    history.undo();
    EXPECT_EQ(now(history), 0.2f);
    history.redo();
    EXPECT_EQ(now(history), 0.3f);
    EXPECT_FALSE(history.canRedo());
    history.undo();
    history.undo();
    history.undo();
    EXPECT_EQ(now(history), 0.1f);
    history.change(rough(0.4f), false);
    EXPECT_FALSE(history.canRedo());
    EXPECT_EQ(history.original().materials[0].roughness, 0.1f);
}

TEST(EditHistory, TakesASlidersMotionBackAtOnce) {
    EditHistory history(rough(0.1f));
    history.change(rough(0.2f), false);
    for (int i = 0; i < 50; ++i) history.change(rough(0.2f + 0.01f * float(i)), true);
    history.undo();
    EXPECT_EQ(now(history), 0.1f);
}

TEST(EditHistory, TellsEveryChangeOfWhatIsShown) {
    EditHistory history(rough(0.1f));
    const uint64_t start = history.revision();
    history.undo();
    EXPECT_EQ(history.revision(), start);
    history.change(rough(0.2f), false);
    const uint64_t changed = history.revision();
    EXPECT_GT(changed, start);
    history.undo();
    EXPECT_GT(history.revision(), changed);
}

}  // namespace
}  // namespace phat
