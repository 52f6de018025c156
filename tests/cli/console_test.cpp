// Standard streams that are closed, full, or gone.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "support/run_program.h"

namespace phat {
namespace {

const std::string kScene = std::string(PHAT_SOURCE_DIR) + "/scenes/cornell-glossy.glb";

// Runs phat with the streams that `redirect` gives it; returns its exit code, or -1 for a signal.
int runWith(const std::function<void()>& redirect, const std::vector<std::string>& arguments) {
    std::vector<char*> argv = {const_cast<char*>(PHAT_PROGRAM)};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const pid_t pid = fork();
    if (pid == 0) {
        redirect();
        execv(PHAT_PROGRAM, argv.data());
        _exit(127);
    }
    int status = 0;
    waitpid(pid, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void sendTo(int stream, const char* path) {
    dup2(open(path, O_WRONLY), stream);
}

// A pipe that nobody reads.
void breakPipe(int stream) {
    int ends[2];
    if (pipe(ends) != 0) _exit(126);
    close(ends[0]);
    dup2(ends[1], stream);
}

std::vector<std::string> bakeTo(const std::string& baked) {
    return {"bake", kScene, "-o", baked, "--resolution", "2k", "--photons", "2k", "--probes", "none"};
}

TEST(Console, WorkOutlivesItsTerminal) {
    const TemporaryFolder folder;
    const std::function<void()> streams[] = {
        [] { sendTo(STDERR_FILENO, "/dev/full"); },
        [] { breakPipe(STDERR_FILENO); },
        [] { close(STDERR_FILENO); },
    };
    for (const auto& redirect : streams) {
        const std::string baked = folder.file("room.phat.glb");
        EXPECT_EQ(runWith([&] { sendTo(STDOUT_FILENO, "/dev/null"), redirect(); }, bakeTo(baked)), 0);
        EXPECT_EQ(runPhat({"info", baked}).exitCode, 0);
        std::filesystem::remove(baked);
        EXPECT_EQ(folder.fileCount(), 0u);
    }
}

// Files that are opened meanwhile would get the numbers of the streams.
TEST(Console, ClosedStreamsAreNoFiles) {
    const TemporaryFolder folder;
    const std::string baked = folder.file("room.phat.glb");
    const auto closeAll = [] {
        for (const int stream : {0, 1, 2}) close(stream);
    };
    std::vector<std::string> arguments = bakeTo(baked);
    arguments.push_back("--quiet");
    EXPECT_EQ(runWith(closeAll, arguments), 0);
    EXPECT_EQ(runPhat({"info", baked}).exitCode, 0);
}

TEST(Console, LostOutputIsAnError) {
    const std::vector<std::string> info{"info", kScene, "--json"};
    EXPECT_EQ(runWith([] { sendTo(STDOUT_FILENO, "/dev/full"); }, info), 1);
    EXPECT_EQ(runWith([] { close(STDOUT_FILENO); }, info), 1);
    EXPECT_EQ(runWith([] { breakPipe(STDOUT_FILENO); }, info), 1);
    EXPECT_EQ(runWith([] { sendTo(STDOUT_FILENO, "/dev/null"); }, info), 0);
}

// A pipe may never end, and has no size.
TEST(Console, PicturesAreReadFromPlainFilesAlone) {
    const TemporaryFolder folder;
    const std::string pipe = folder.file("pipe.png");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    const auto result = runPhat({"compare", pipe, pipe});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_EQ(result.err, "phat: " + pipe + ": not a plain file\n");
}

}  // namespace
}  // namespace phat
