#include "viewer/edit_history.h"

#include <cassert>
#include <utility>

namespace phat {
namespace {

// A state is a few kilobytes.
constexpr size_t kMaxStates = 1000;

}  // namespace

EditHistory::EditHistory(SceneEdits start) : original_(start), states_{std::move(start)} {}

void EditHistory::change(SceneEdits next, bool goesOn) {
    ++revision_;
    states_.resize(at_ + 1);
    if (goesOn && at_ > 0) {
        states_[at_] = std::move(next);
        return;
    }
    if (states_.size() == kMaxStates) states_.erase(states_.begin());
    states_.push_back(std::move(next));
    at_ = states_.size() - 1;
}

void EditHistory::drop() {
    assert(canUndo() && !canRedo());
    states_.resize(at_);
    --at_;
    ++revision_;
}

void EditHistory::undo() {
    if (!canUndo()) return;
    --at_;
    ++revision_;
}

void EditHistory::redo() {
    if (!canRedo()) return;
    ++at_;
    ++revision_;
}

}  // namespace phat
