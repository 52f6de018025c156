#include "io/base/machine_memory.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"

namespace phat {
namespace {

namespace fs = std::filesystem;

// A file system with the files that Linux tells limits in.
struct MachineMemory : testing::Test {
    TemporaryFolder root;

    void write(const std::string& path, const std::string& text) const {
        fs::create_directories((root.path / path).parent_path());
        std::ofstream(root.path / path) << text;
    }
    uint64_t limit() const { return memoryLimitOfMachine(root.path); }
};

TEST_F(MachineMemory, IsThatOfTheHardwareWithoutGroups) {
    EXPECT_GT(limit(), 100'000'000u);
    write("proc/self/cgroup", "0::/\n");
    write("sys/fs/cgroup/memory.max", "max\n");
    EXPECT_EQ(limit(), memoryLimitOfMachine(root.path / "nothing"));
}

TEST_F(MachineMemory, IsTheLeastOfTheGroupsAround) {
    write("proc/self/cgroup", "0::/farm/job\n");
    write("sys/fs/cgroup/farm/memory.max", "50000000\n");
    write("sys/fs/cgroup/farm/job/memory.max", "max\n");
    EXPECT_EQ(limit(), 50'000'000u);
    write("sys/fs/cgroup/farm/job/memory.max", "30000000\n");
    EXPECT_EQ(limit(), 30'000'000u);
    write("sys/fs/cgroup/other/memory.max", "1000\n");
    EXPECT_EQ(limit(), 30'000'000u);
}

TEST_F(MachineMemory, IsAContainersOwnLimit) {
    write("proc/self/cgroup", "0::/docker/1234\n");  // as the machine sees it
    write("sys/fs/cgroup/memory.max", "40000000\n");
    EXPECT_EQ(limit(), 40'000'000u);
}

TEST_F(MachineMemory, KnowsVersionOne) {
    write("proc/self/cgroup", "12:cpu,cpuacct:/job\n5:hugetlb,memory:/job\n0::/\n");
    write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
    write("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "20000000\n");
    EXPECT_EQ(limit(), 20'000'000u);
}

TEST(ProcessMemory, HoldsWhatIsHeld) {
    constexpr size_t kBytes = 64 << 20;
    {
        const std::vector<char> held(kBytes, 1);
        EXPECT_GE(memoryOfProcess().now, kBytes);
    }
    const ProcessMemory after = memoryOfProcess();
    EXPECT_GE(after.peak, kBytes);
    EXPECT_LT(after.now, after.peak);
}

}  // namespace
}  // namespace phat
