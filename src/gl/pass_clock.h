#pragma once
// The GPU's time by pass, from timestamps at the passes' ends.

#include <vector>

#include "gl/gl_objects.h"

namespace phat {

enum class Pass : uint8_t {
    none,  // time between passes, such as rays on the CPU
    relight,
    pyramid,
    shadows,
    depth,
    lobes,
    lookup,
    pool,
    rayGuides,
    rayTrace,
    rayShade,
    rayLights,
    rayPool,
    display,
};

class PassClock {
  public:
    /// A new frame begins here. pre: a complete framebuffer is bound, also for ended().
    void restart();
    /// Attributes the time since the last call to `pass`.
    void ended(Pass pass);
    /// Of all of the frame's runs of a pass. Waits for the GPU.
    double seconds(Pass pass) const;

  private:
    void stamp();

    std::vector<GlQuery> stamps_;  // kept from frame to frame
    std::vector<Pass> passes_;     // what ended at the stamp after the same one
    size_t used_ = 0;
};

}  // namespace phat
