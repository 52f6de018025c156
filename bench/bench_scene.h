#pragma once
// What the benchmarks share: a scene of the repository, and clocks.

#include <benchmark/benchmark.h>

#include <map>
#include <string>

#include "core/base/progress.h"
#include "core/base/stopwatch.h"
#include "core/scene/scene.h"
#include "io/gltf/gltf_loader.h"

namespace phat {

inline Scene benchScene(const std::string& name) {
    return loadGltf(std::string(PHAT_SOURCE_DIR "/scenes/") + name + ".glb").scene;
}

/// Seconds by stage; stages of one name together.
class StageClock : public Progress {
  public:
    void begin(const char* stage, uint64_t) override {
        stage_ = stage;
        start_ = Stopwatch();
    }
    void advance(uint64_t) override {}
    void end() override { seconds[stage_] += start_.seconds(); }
    bool stopRequested() const override { return false; }

    std::map<std::string, double> seconds;

  private:
    std::string stage_;
    Stopwatch start_;
};

}  // namespace phat
