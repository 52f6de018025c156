// phat web and the size of what it sends, through the whole program.

#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <stdexcept>

#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

const std::string kScene = PHAT_SOURCE_DIR "/scenes/cornell-glossy.glb";

// What others do with a file or in a folder from now on.
class Watch {
  public:
    explicit Watch(const std::string& path, uint32_t events) : queue_(inotify_init1(IN_NONBLOCK)) {
        if (inotify_add_watch(queue_, path.c_str(), events) < 0) throw std::runtime_error(path);
    }
    ~Watch() { close(queue_); }
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

    // Of the file that was named, or of that one in the folder.
    int count(const std::string& name = "") {
        int result = 0;
        alignas(inotify_event) std::array<char, 4096> buffer;
        for (ssize_t size; (size = read(queue_, buffer.data(), buffer.size())) > 0;)
            for (ssize_t at = 0; at < size;) {
                const auto* event = reinterpret_cast<const inotify_event*>(buffer.data() + at);
                result += name == (event->len > 0 ? event->name : "");
                at += ssize_t(sizeof(inotify_event)) + event->len;
            }
        return result;
    }

  private:
    int queue_;
};

TEST(WebFiles, APageIsWrittenWithoutReadingTheBakeTwice) {
    const TemporaryFolder folder, site;
    const std::string baked = folder.file("room.phat.glb");
    const auto result = runPhat(
        {"bake", kScene, "-o", baked, "--resolution", "8k", "--photons", "1k", "--probes", "8", "--quiet"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    Watch reads(baked, IN_OPEN), writes(site.file("."), IN_MOVED_TO);
    const auto written = runPhat({"web", baked, "-o", site.file("."), "--poster-width", "64", "--quiet"});
    ASSERT_EQ(written.exitCode, 0) << written.err;
    EXPECT_EQ(reads.count(), 1);
    // Its list before all others, and, where an older page may have left some, after them.
    EXPECT_EQ(writes.count("phat-web.txt"), 2);
}

TEST(WebFiles, MaxMegabytesIsKept) {
    const TemporaryFolder folder;
    const std::string out = folder.file("room.phat.glb");
    for (const double megabytes : {0.2, 0.6}) {
        const auto result = runPhat({"bake", kScene, "-o", out, "--max-megabytes", std::to_string(megabytes),
                                     "--photons", "20k", "--paths", "1", "--quiet"});
        ASSERT_EQ(result.exitCode, 0) << result.err;
        const double size = double(std::filesystem::file_size(out)) * 1e-6;
        EXPECT_LE(size, megabytes);
        EXPECT_GE(size, 0.5 * megabytes);
    }
    const auto written = std::filesystem::last_write_time(out);
    const auto tooSmall =
        runPhat({"bake", kScene, "-o", out, "--max-megabytes", "0.0101", "--photons", "1k"});
    EXPECT_EQ(tooSmall.exitCode, 1);
    EXPECT_NE(tooSmall.err.find("--max-megabytes"), std::string::npos) << tooSmall.err;
    EXPECT_EQ(std::filesystem::last_write_time(out), written);
    EXPECT_EQ(folder.fileCount(), 1u);
}

TEST(WebFiles, APageNeedsABake) {
    const TemporaryFolder folder;
    const auto result = runPhat({"web", kScene, "-o", folder.file("site")});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_EQ(result.err, "phat: " + kScene + ": is not a baked file: `phat bake` makes one\n");
    EXPECT_EQ(folder.fileCount(), 0u);
}

}  // namespace
}  // namespace phat
