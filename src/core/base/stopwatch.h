#pragma once
// Elapsed time, by the clock on the wall and by the processor.

#include <chrono>
#include <ctime>

namespace phat {

/// Counts from its construction.
class Stopwatch {
  public:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

/// Seconds that body() takes.
template <typename Body>
double secondsOf(const Body& body) {
    const Stopwatch start;
    body();
    return start.seconds();
}

/// Seconds that the calling thread has been running.
inline double threadProcessorSeconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

}  // namespace phat
