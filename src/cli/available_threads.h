#pragma once
// Threads that the system lets the program make.

#include <tbb/global_control.h>

#include <optional>

namespace phat {

/// Limits oneTBB, which ends the program where it cannot make a thread, to those that can be made, for as
/// long as the result lives. Throws std::runtime_error where there is none beside this one: drivers and
/// libraries count on them.
std::optional<tbb::global_control> useAvailableThreads();

}  // namespace phat
