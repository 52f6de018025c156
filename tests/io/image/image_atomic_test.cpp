#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <climits>
#include <set>
#include <stdexcept>

#include "io/base/atomic_file.h"
#include "io/base/file_error.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

const std::vector<uint8_t> kBytes{1, 2, 3};

TEST(ReplaceFile, WritesAndReplaces) {
    const TemporaryFolder folder;
    replaceFile(folder.file("a"), std::vector<uint8_t>{9});
    replaceFile(folder.file("a"), kBytes);
    EXPECT_EQ(readBytes(folder.file("a")), (std::vector<char>{1, 2, 3}));
    EXPECT_EQ(folder.fileCount(), 1u);
}

TEST(ReplaceFile, FailureKeepsTheOldFileAndLeavesNoOther) {
    const TemporaryFolder folder;
    replaceFile(folder.file("a"), kBytes);
    const auto failing = [](const std::string& temporary) {
        writeBytes(temporary, {7});
        throw std::runtime_error("the writer failed");
    };
    EXPECT_THROW(replaceFile(folder.file("a"), failing), std::runtime_error);
    EXPECT_THROW(replaceFile(folder.file("b"), failing), std::runtime_error);
    EXPECT_EQ(readBytes(folder.file("a")), (std::vector<char>{1, 2, 3}));
    EXPECT_EQ(folder.fileCount(), 1u);
}

// A process id that no process has: that of a child that is gone.
pid_t deadProcess() {
    const pid_t child = fork();
    if (child == 0) _exit(0);
    waitpid(child, nullptr, 0);
    return child;
}

TEST(ReplaceFile, RemovesWhatKilledRunsHaveLeft) {
    const TemporaryFolder folder;
    const std::string dead = std::to_string(deadProcess()), alive = std::to_string(getppid());
    const std::string longName = folder.file(std::string(NAME_MAX, 'x'));
    for (const std::string& path : {folder.file("a"), longName}) {
        const std::string stale = nameBeside(path, ".tmp-" + dead + "-0");
        writeBytes(stale, {7});
        replaceFile(path, kBytes);
        EXPECT_FALSE(std::filesystem::exists(stale));
    }
    const std::set<std::string> others{
        folder.file("a.tmp-" + alive + "-0"), folder.file("b.tmp-" + dead + "-0"),
        folder.file("a.tmp-" + dead + "-0.png"), folder.file("a.tmp-" + dead), folder.file("a.tmp-x-0")};
    for (const std::string& other : others) writeBytes(other, {7});
    replaceFile(folder.file("a"), kBytes);
    for (const std::string& other : others) EXPECT_TRUE(std::filesystem::exists(other)) << other;
}

// Process ids mean nothing to who shares a folder with another container; locks do.
TEST(ReplaceFile, LeavesNewFilesThatAreInUse) {
    const TemporaryFolder folder;
    const std::string inUse = folder.file("a.tmp-" + std::to_string(deadProcess()) + "-0");
    replaceFile(folder.file("a"), [&](const std::string& temporary) {
        ASSERT_EQ(std::rename(temporary.c_str(), inUse.c_str()), 0);
        replaceFile(folder.file("a"), kBytes);
        EXPECT_TRUE(std::filesystem::exists(inUse));
        ASSERT_EQ(std::rename(inUse.c_str(), temporary.c_str()), 0);
    });
}

TEST(ReplaceFile, FollowsLinks) {
    const TemporaryFolder folder;
    replaceFile(folder.file("target"), std::vector<uint8_t>{9});
    std::filesystem::create_symlink("target", folder.file("link"));
    replaceFile(folder.file("link"), kBytes);
    EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link")));
    EXPECT_EQ(readBytes(folder.file("target")), (std::vector<char>{1, 2, 3}));
}

TEST(ReplaceFile, WritesThroughLinksThatDangle) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.path / "real");
    std::filesystem::create_symlink("real/made", folder.file("inner"));
    std::filesystem::create_symlink(folder.path / "inner", folder.file("outer"));
    replaceFile(folder.file("outer"), kBytes);
    EXPECT_TRUE(std::filesystem::is_symlink(folder.file("outer")));
    EXPECT_TRUE(std::filesystem::is_symlink(folder.file("inner")));
    EXPECT_EQ(readBytes(folder.file("real/made")), (std::vector<char>{1, 2, 3}));
    std::filesystem::create_symlink("circle", folder.file("circle"));
    EXPECT_THROW(replaceFile(folder.file("circle"), kBytes), FileError);
}

TEST(ReplaceFile, KeepsTheModeOfTheOldFile) {
    using std::filesystem::perms;
    const TemporaryFolder folder;
    replaceFile(folder.file("a"), std::vector<uint8_t>{9});
    for (const perms mode : {perms(0640), perms(0600), perms(0664)}) {
        std::filesystem::permissions(folder.file("a"), mode);
        replaceFile(folder.file("a"), kBytes);
        EXPECT_EQ(std::filesystem::status(folder.file("a")).permissions(), mode);
    }
}

TEST(ReplaceFile, TakesNamesAsLongAsFileSystemsDo) {
    const TemporaryFolder folder;
    std::string name;
    while (name.size() + 2 <= 255) name += "\u00fc";  // two bytes, none of which may stand alone
    replaceFile(folder.file(name), kBytes);
    EXPECT_EQ(readBytes(folder.file(name)), (std::vector<char>{1, 2, 3}));
    EXPECT_EQ(folder.fileCount(), 1u);
    const std::string journal = nameBeside(folder.file(name), ".journal");
    EXPECT_LE(journal.size() - folder.path.string().size() - 1, 255u);
    EXPECT_TRUE(journal.ends_with("\u00fc.journal"));
    EXPECT_EQ(nameBeside("a/b", ".c"), "a/b.c");
}

TEST(ReplaceFile, RefusesFoldersAndDevices) {
    const TemporaryFolder folder;
    EXPECT_THROW(replaceFile(folder.path.string(), kBytes), FileError);
    EXPECT_THROW(replaceFile("/dev/null", kBytes), FileError);
    EXPECT_THROW(replaceFile(folder.file("no/such/folder"), kBytes), FileError);
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

}  // namespace
}  // namespace phat
