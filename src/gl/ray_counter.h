#pragma once
// How many rays the GPU traced for a frame.

#include <vector>

#include "gl/gl_objects.h"

namespace phat {

/// Counts the fragments that passes write; those without a ray are discarded.
class RayCounter {
  public:
    /// A new frame begins here.
    void restart() { used_ = 0; }
    /// Around a pass. pre: they alternate.
    void begin();
    void end();
    /// Of all of the frame's passes. Waits for the GPU.
    uint64_t rays() const;

  private:
    std::vector<GlQuery> queries_;  // kept from frame to frame
    size_t used_ = 0;
};

}  // namespace phat
