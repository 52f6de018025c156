#include "io/base/machine_memory.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

namespace phat {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kUnlimited = std::numeric_limits<uint64_t>::max();

// "max" of version 2 is no number; version 1 has a number that no machine reaches.
uint64_t limitIn(const fs::path& file) {
    uint64_t bytes = 0;
    return std::ifstream(file) >> bytes ? bytes : kUnlimited;
}

// Of a group and of those around it. A container's own view of the tree may begin at its group, whose path
// from outside leads nowhere then: what is at the top counts in any case.
uint64_t limitOfGroup(const fs::path& tree, const std::string& group, const char* file) {
    uint64_t least = limitIn(tree / file);
    for (fs::path inner = fs::path(group).relative_path(); !inner.empty(); inner = inner.parent_path())
        least = std::min(least, limitIn(tree / inner / file));
    return least;
}

bool hasController(const std::string& controllers, const std::string& name) {
    std::istringstream list(controllers);
    for (std::string one; std::getline(list, one, ',');)
        if (one == name) return true;
    return false;
}

uint64_t physicalMemory() {
    return uint64_t(sysconf(_SC_PHYS_PAGES)) * uint64_t(sysconf(_SC_PAGE_SIZE));
}

}  // namespace

uint64_t memoryLimitOfMachine(const fs::path& root) {
    uint64_t least = physicalMemory();
    const fs::path tree = root / "sys/fs/cgroup";
    std::ifstream groups(root / "proc/self/cgroup");
    // "0::/group" of version 2, "5:memory:/group" of version 1
    for (std::string line; std::getline(groups, line);) {
        const size_t first = line.find(':'), second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1),
                          group = line.substr(second + 1);
        if (controllers.empty())
            least = std::min({least, limitOfGroup(tree, group, "memory.max"),
                              limitOfGroup(tree / "unified", group, "memory.max")});
        else if (hasController(controllers, "memory"))
            least = std::min(least, limitOfGroup(tree / "memory", group, "memory.limit_in_bytes"));
    }
    return least;
}

ProcessMemory memoryOfProcess() {
    ProcessMemory memory;
    std::ifstream status("/proc/self/status");
    for (std::string name; status >> name; status.ignore(std::numeric_limits<std::streamsize>::max(), '\n')) {
        uint64_t kilobytes = 0;
        if (name == "VmRSS:" && status >> kilobytes) memory.now = kilobytes * 1024;
        if (name == "VmHWM:" && status >> kilobytes) memory.peak = kilobytes * 1024;
    }
    return memory;
}

}  // namespace phat
