// phat as a child process: what it leaves behind, whatever happens.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "run_program.h"

namespace phat {
namespace {

using Clock = std::chrono::steady_clock;

const std::string kScene = PHAT_SOURCE_DIR "/scenes/tabletop.glb";

std::vector<std::string> bakeArguments(const std::string& out, const std::string& resolution,
                                       const std::string& paths, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"bake", kScene, "-o", out, "--photons", "2k", "--bounces", "3"};
    arguments.insert(arguments.end(), {"--resolution", resolution, "--paths", paths});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

std::vector<std::string> smallBake(const std::string& out, const std::vector<std::string>& more = {}) {
    return bakeArguments(out, "4k", "1", more);
}

// Some seconds, to be met in the middle.
std::vector<std::string> slowBake(const std::string& out, const std::vector<std::string>& more) {
    return bakeArguments(out, "60k", "8", more);
}

long lineCount(const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
}

// A child that can be signalled; stderr goes to a file.
struct Child {
    pid_t pid = -1;

    Child(const std::vector<std::string>& arguments, const std::string& errPath) {
        std::vector<char*> argv = {const_cast<char*>(PHAT_PROGRAM)};
        for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
        argv.push_back(nullptr);
        pid = fork();
        if (pid != 0) return;
        dup2(open(errPath.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
        dup2(open("/dev/null", O_WRONLY), STDOUT_FILENO);
        execv(PHAT_PROGRAM, argv.data());
        _exit(127);
    }
    int wait() const {
        int status = 0;
        waitpid(pid, &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
};

bool waitUntil(const std::function<bool()>& condition) {
    for (int i = 0; i < 6000; ++i) {
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
}

TEST(ConductBake, WritesTheFileAndNothingElse) {
    const TemporaryFolder folder;
    const auto result = runPhat(smallBake(folder.file("out.phat.glb"), {"--json"}));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(folder.fileCount(), 1u);
    const auto stats = nlohmann::json::parse(result.out);
    EXPECT_EQ(stats["bytes"], readBytes(folder.file("out.phat.glb")).size());
    EXPECT_GT(stats["phatexels"]["valid"], 1000);
    // A log, not a terminal: nothing that moves the cursor.
    EXPECT_EQ(result.err.find_first_of("\r\x1b"), std::string::npos);
    EXPECT_NE(result.err.find("photons: 100 %"), std::string::npos) << result.err;
    EXPECT_EQ(runPhat(smallBake(folder.file("out.phat.glb"), {"--quiet"})).err, "");
}

TEST(ConductBake, NamesTheFileAndTheReasonInOneLine) {
    const TemporaryFolder folder;
    const std::string broken = folder.file("broken.glb");
    writeBytes(broken, {'g', 'l', 'T', 'F', 2, 0});
    for (const std::string& input : {folder.file("missing.glb"), broken}) {
        const auto result = runPhat({"bake", input, "-o", folder.file("out.glb")});
        EXPECT_EQ(result.exitCode, 1);
        EXPECT_EQ(lineCount(result.err), 1) << result.err;
        EXPECT_EQ(result.err.rfind("phat: " + input + ": ", 0), 0u) << result.err;
        EXPECT_GT(result.err.size(), input.size() + 15);
    }
    const auto unwritable = runPhat(smallBake(folder.file("no/such/folder/out.glb")));
    EXPECT_EQ(unwritable.exitCode, 1);
    EXPECT_EQ(lineCount(unwritable.err), 1) << unwritable.err;
    EXPECT_EQ(folder.fileCount(), 1u);
}

TEST(ConductBake, RefusesWrongUsage) {
    const TemporaryFolder folder;
    const std::vector<std::vector<std::string>> wrong = {
        {"--samples", "0"},     {"--texel-size", "-1"},  {"--resolution", "12x"}, {"--directions", "up"},
        {"--photons", "nan"},   {"--memory-limit", "0"}, {"--threads", "0"},      {"--gutter", "x"},
        {"--texel-size", ".1"}, {"--no-such-flag"},      {"--use-uv", "7"},       {"--seed", "-1"}};
    for (const auto& arguments : wrong) {  // --texel-size beside --resolution
        const auto result = runPhat(smallBake(folder.file("out.glb"), arguments));
        EXPECT_EQ(result.exitCode, 2) << arguments[0] << result.err;
        EXPECT_EQ(lineCount(result.err), 1) << result.err;
    }
    EXPECT_EQ(runPhat({"bake", kScene, "-o", kScene}).exitCode, 2);
    EXPECT_EQ(folder.fileCount(), 0u);
}

TEST(ConductBake, RefusesMoreMemoryThanAllowed) {
    const TemporaryFolder folder;
    const auto start = Clock::now();
    const auto result = runPhat(
        {"bake", kScene, "-o", folder.file("out.glb"), "--resolution", "400M", "--memory-limit", "2"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_EQ(lineCount(result.err), 1) << result.err;
    EXPECT_NE(result.err.find("GB"), std::string::npos);
    EXPECT_LT(Clock::now() - start, std::chrono::seconds(10));
    EXPECT_EQ(folder.fileCount(), 0u);
}

TEST(ConductBake, GivesTheSameBytesOnAnyNumberOfThreads) {
    const TemporaryFolder folder;
    std::vector<char> first;
    for (const char* threads : {"1", "2", "8"}) {
        const std::string out = folder.file(std::string(threads) + ".glb");
        const auto result = runPhat(smallBake(out, {"--threads", threads, "--quiet"}));
        ASSERT_EQ(result.exitCode, 0) << result.err;
        if (first.empty()) first = readBytes(out);
        EXPECT_EQ(first, readBytes(out)) << threads;
    }
    ASSERT_EQ(runPhat(smallBake(folder.file("other.glb"), {"--seed", "2", "--quiet"})).exitCode, 0);
    EXPECT_NE(first, readBytes(folder.file("other.glb")));
}

TEST(ConductBake, StopsWithinASecondAndGoesOnWhereItWas) {
    const TemporaryFolder folder;
    const std::string out = folder.file("out.glb"), journal = out + ".journal", err = folder.file("err");
    ASSERT_EQ(runPhat(slowBake(folder.file("whole.glb"), {"--quiet"})).exitCode, 0);

    for (const int signal : {SIGINT, SIGTERM}) {
        const Child child(slowBake(out, {"--quiet", "--resume"}), err);
        const size_t before = readBytes(journal).size();
        ASSERT_TRUE(waitUntil([&] { return readBytes(journal).size() > before + 9000; }));
        const auto start = Clock::now();
        kill(child.pid, signal);
        EXPECT_EQ(child.wait(), 130);
        EXPECT_LT(Clock::now() - start, std::chrono::seconds(1));
        const auto said = readBytes(err);
        EXPECT_NE(std::string(said.begin(), said.end()).find("--resume"), std::string::npos);
        EXPECT_FALSE(std::filesystem::exists(out));
    }
    EXPECT_EQ(folder.fileCount(), 3u);  // whole.glb, err, the journal

    const auto resumed = runPhat(slowBake(out, {"--json", "--resume"}));
    ASSERT_EQ(resumed.exitCode, 0) << resumed.err;
    EXPECT_GT(nlohmann::json::parse(resumed.out)["resumedParts"], 0);
    EXPECT_EQ(readBytes(out), readBytes(folder.file("whole.glb")));
    EXPECT_FALSE(std::filesystem::exists(journal));
}

// One part of the journal takes far longer than a second here: it is given up in its middle.
TEST(ConductBake, StopsWithinASecondInsideALongPart) {
    const TemporaryFolder folder;
    const std::string out = folder.file("out.glb"), journal = out + ".journal", err = folder.file("err");
    // The progress tells when the last stage, the long one, has begun; it writes no line sooner than 10 s
    // after that.
    const Child child(bakeArguments(out, "4k", "20000", {"--threads", "1"}), err);
    const auto said = [&] {
        const auto bytes = readBytes(err);
        return std::string(bytes.begin(), bytes.end());
    };
    ASSERT_TRUE(waitUntil([&] {
        const std::string text = said();
        const size_t last = text.rfind("directions: 100 %");
        return last != std::string::npos && last != text.find("directions: 100 %");
    })) << said();
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    ASSERT_EQ(said().find("indirect light: 100 %"), std::string::npos);
    const auto start = Clock::now();
    kill(child.pid, SIGINT);
    EXPECT_EQ(child.wait(), 130);
    EXPECT_LT(Clock::now() - start, std::chrono::seconds(1));
    EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace phat
