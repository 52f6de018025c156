#pragma once

#include <ctime>

namespace phat {

/// Seconds that the calling thread has been running.
inline double threadProcessorSeconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

}  // namespace phat
