#include <gtest/gtest.h>

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

TEST(ReplaceFile, FollowsLinks) {
    const TemporaryFolder folder;
    replaceFile(folder.file("target"), std::vector<uint8_t>{9});
    std::filesystem::create_symlink("target", folder.file("link"));
    replaceFile(folder.file("link"), kBytes);
    EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link")));
    EXPECT_EQ(readBytes(folder.file("target")), (std::vector<char>{1, 2, 3}));
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
