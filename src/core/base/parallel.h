#pragma once
// Loops over all cores. Results must not depend on the assignment of indices to threads: each index writes
// its own element.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/base/progress.h"

namespace phat {

/// Calls body(begin, end) over [0, count) in ranges of at most `grain`, reports progress in indices, and
/// throws Interrupted when asked to stop.
template <typename Body>
void parallelRanges(size_t count, size_t grain, Progress& progress, const Body& body) {
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, count, grain),
        [&](const tbb::blocked_range<size_t>& range) {
            progress.throwIfStopped();
            body(range.begin(), range.end());
            progress.advance(range.size());
        },
        tbb::simple_partitioner());
}

}  // namespace phat
