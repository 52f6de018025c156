#pragma once
// What was changed by hand, with a way back.

#include <cstdint>
#include <vector>

#include "core/scene.h"

namespace phat {

/// Everything that can be edited without a new bake.
struct Editable {
    std::vector<Material> materials;
    std::vector<PunctualLight> lights;
};

class EditHistory {
  public:
    explicit EditHistory(Editable start = {});

    const Editable& now() const { return states_[at_]; }
    const Editable& original() const { return original_; }

    /// A new state; what was undone before is gone. `goesOn`: the same slider is still held, so that one undo
    /// takes all of its motion back.
    void change(Editable next, bool goesOn);

    bool canUndo() const { return at_ > 0; }
    bool canRedo() const { return at_ + 1 < states_.size(); }
    void undo();
    void redo();
    /// Grows with every change of now().
    uint64_t revision() const { return revision_; }

  private:
    Editable original_;
    std::vector<Editable> states_;
    size_t at_ = 0;
    uint64_t revision_ = 0;
};

}  // namespace phat
