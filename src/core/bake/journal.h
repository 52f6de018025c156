#pragma once
// Where an interrupted bake is taken up again.

#include <cstdint>
#include <vector>

namespace phat {

/// Finished parts of the slow stage, so that an interrupted bake goes on where it was. Implemented by io.
class BakeJournal {
  public:
    virtual ~BakeJournal() = default;
    /// Bytes stored under `key` by an earlier run, empty if there are none.
    virtual std::vector<uint8_t> load(uint64_t key) = 0;
    /// Called from any thread; must be durable when it returns.
    virtual void store(uint64_t key, const std::vector<uint8_t>& bytes) = 0;
};

}  // namespace phat
