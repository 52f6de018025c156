#pragma once
// The kinds of work of the incremental baker, and how much of each has been done.

#include <array>
#include <cstddef>
#include <cstdint>

namespace phat {

enum class BakerTask : uint8_t { moved, retraceInvalidated, photons, areaLight, nodes, maps, blocks };
inline constexpr size_t kBakerTasks = 7;

/// Work done so far, by BakerTask.
struct BakerStats {
    struct Task {
        uint64_t items = 0;  // tiles, parts of the photon map, regions, nodes, blocks; of `moved`: rounds
        uint64_t work = 0;
        double seconds = 0;
    };
    std::array<Task, kBakerTasks> tasks;
    Task areaMaps, indirectMaps;  // filtered, bounced and stitched
    uint64_t phatexels = 0;       // updated
};

/// How much of each task's items is up to date with the scene as it is, from 0 to 1, by BakerTask.
using UpToDateFractions = std::array<float, kBakerTasks>;

/// One number for all tasks: PHATexels count half, because each depends on all else.
inline float overall(const UpToDateFractions& upToDate) {
    float sum = 0.5f * upToDate[size_t(BakerTask::blocks)];
    for (size_t t = 0; t + 1 < kBakerTasks; ++t) sum += 0.5f / float(kBakerTasks - 1) * upToDate[t];
    return sum;
}

}  // namespace phat
