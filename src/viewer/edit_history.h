#pragma once
// The history of edits, for undo and redo.

#include <cstdint>
#include <vector>

#include "core/scene/scene_edits.h"

namespace phat {

class EditHistory {
  public:
    explicit EditHistory(SceneEdits start = {});

    const SceneEdits& now() const { return states_[at_]; }
    const SceneEdits& original() const { return original_; }

    /// A new state; what was undone before is gone. `goesOn`: the same slider is still held, so that one undo
    /// takes all of its motion back.
    void change(SceneEdits next, bool goesOn);

    /// Takes back the last change for good. pre: canUndo(), and nothing was undone since.
    void drop();

    bool canUndo() const { return at_ > 0; }
    bool canRedo() const { return at_ + 1 < states_.size(); }
    void undo();
    void redo();
    /// Grows with every change of now().
    uint64_t revision() const { return revision_; }

  private:
    SceneEdits original_;
    std::vector<SceneEdits> states_;
    size_t at_ = 0;
    uint64_t revision_ = 0;
};

}  // namespace phat
