#pragma once
// Dynamic lighting in the window: the incremental baker beside the renderer, or the renderer's own light, for
// which the baker only follows the geometry.

#include <memory>
#include <optional>

#include "core/dynamic/baker_thread.h"
#include "viewer/light_rounds.h"
#include "viewer/viewer_state.h"

namespace phat {

class LightFollower {
  public:
    /// Drops updates, for another bake.
    void reset();
    /// Asks for the light of what is shown now and gives the renderer what has been updated, for so long as a
    /// frame can spare. The first change begins it. What goes wrong is told in the state's message, and light
    /// stays as it is until reset(). `changed`: since the last call; `visible`: somebody may be looking. pre:
    /// a renderer and a whole bake.
    void follow(ViewerState& state, bool changed, bool visible);
    /// There is more to give than the last frame had time for.
    bool hasMore() const { return !update_.empty() || (roundsGoOn_ && rounds_.hasMore()); }
    /// Before what it reads is written to.
    void waitUntilStarted();
    std::optional<BakerThread::Report> report() const;

  private:
    void begin(const Document& document);
    void followByBaker(ViewerState& state, bool changed, bool visible, bool updatesLight);

    std::unique_ptr<BakerThread> light_;
    LightRounds rounds_;
    bool roundsGoOn_ = false;
    bool roundsBehind_ = false;  // of changes, also of those while they did not go on
    bool failed_ = false;
    LightUpdate update_;  // not uploaded yet
    bool updates_ = false, refines_ = false;
    glm::mat4 eye_{1};  // that light was last asked for
};

}  // namespace phat
