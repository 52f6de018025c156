#pragma once
// How long work reports and how it is stopped. core knows nothing of terminals.

#include <atomic>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace phat {

/// Thrown from a stage when it was asked to stop.
struct Interrupted : std::runtime_error {
    explicit Interrupted(const std::string& what = "interrupted") : std::runtime_error(what) {}
};

/// Implemented by the command line and the viewer; calls may come from any thread.
class Progress {
  public:
    virtual ~Progress() = default;
    /// A stage begins; `total` is in its own units (texels, photons).
    virtual void begin(const char* stage, uint64_t total) = 0;
    virtual void advance(uint64_t done) = 0;
    virtual void end() = 0;
    /// Long loops poll this at least every 100 ms.
    virtual bool stopRequested() const = 0;

    void throwIfStopped() const {
        if (stopRequested()) throw Interrupted();
    }
};

/// Reports nothing, never stops.
class SilentProgress : public Progress {
  public:
    void begin(const char*, uint64_t) override {}
    void advance(uint64_t) override {}
    void end() override {}
    bool stopRequested() const override { return false; }
};

/// RAII guard of a progress stage: ends it on every exit from the scope.
class ProgressStage {
  public:
    ProgressStage(Progress& progress, const char* name, uint64_t total) : progress_(progress) {
        progress_.begin(name, total);
    }
    ~ProgressStage() { progress_.end(); }
    ProgressStage(const ProgressStage&) = delete;
    ProgressStage& operator=(const ProgressStage&) = delete;

  private:
    Progress& progress_;
};

}  // namespace phat
