#pragma once
// How much memory a program may take before something ends it.

#include <cstdint>
#include <filesystem>

namespace phat {

/// The machine's memory, or the limit of the control group that this process is in, or of one around that,
/// where it is less: of version 2 or 1. `root`: of the file system. source: Linux,
/// Documentation/admin-guide/cgroup-v2.rst and cgroup-v1/memory.rst.
uint64_t memoryLimitOfMachine(const std::filesystem::path& root = "/");

/// What this process holds of the machine's memory, in bytes; 0 where nobody knows.
struct ProcessMemory {
    uint64_t now = 0, peak = 0;
};
ProcessMemory memoryOfProcess();

}  // namespace phat
