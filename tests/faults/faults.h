#pragma once
// What faults.cpp makes fail, as it is told by the environment of the program that it is preloaded into
// (LD_PRELOAD): PHAT_FAULT=KIND:NUMBER.

#include <cstdint>

namespace phat::faults {

inline constexpr const char* kFaultVariable = "PHAT_FAULT";
/// Where the numbers of allocations and of operations on files are written when the program ends.
inline constexpr const char* kCountsVariable = "PHAT_FAULT_COUNTS";

/// "new": allocation NUMBER throws, once; "own-new": the same, where those of libraries do not count;
/// "no-space": from operation NUMBER on plain files on, those that need space fail with ENOSPC;
/// "broken-disk": operation NUMBER fails with EIO, once; "no-threads": no thread can be made.
inline constexpr const char* kKinds[] = {"new", "own-new", "no-space", "broken-disk", "no-threads"};

}  // namespace phat::faults
