#pragma once
// Reflections by rays in the window: while the picture is at rest, as long as they are quick enough.

#include "core/base/stopwatch.h"
#include "core/scene/lights.h"
#include "gl/traced_frame.h"
#include "viewer/document.h"

namespace phat {

class LiveReflections {
  public:
    /// Of the document as it is shown now; made anew when that changes. pre: the document has a bake and
    /// outlives it.
    explicit LiveReflections(const Document& document);

    /// For a draw of one sample, which throws Interrupted when its rays take longer than so many seconds; 0:
    /// however long.
    const TracedReflections& within(double seconds);

  private:
    class Limit : public SilentProgress {
      public:
        void begin(const char*, uint64_t) override { start_ = Stopwatch(); }
        bool stopRequested() const override;
        double seconds = 0;

      private:
        Stopwatch start_;
    };
    SharedSnapshot shown_;
    LightSampler lights_;
    ReflectionScene scene_;
    Limit limit_;
    TracedReflections traced_;
};

}  // namespace phat
