// phat as a child process: what it leaves behind, whatever happens.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/base/hemisphere_map.h"
#include "core/base/random.h"
#include "core/base/stopwatch.h"
#include "support/gltf_writer.h"
#include "support/run_program.h"
#include "support/scene_builder.h"

namespace phat {
namespace {

using Clock = std::chrono::steady_clock;

const std::string kScene = PHAT_SOURCE_DIR "/scenes/tabletop.glb";

std::vector<std::string> bakeArguments(const std::string& out, const std::string& resolution,
                                       const std::string& paths, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"bake", kScene, "-o", out, "--photons", "2k", "--bounces", "3"};
    arguments.insert(arguments.end(), {"--resolution", resolution, "--paths", paths, "--probes", "64"});
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

// What is promised is a second on an idle machine. What would be waited for otherwise, the rest of the part,
// takes minutes in the test of a long part.
constexpr double kStopSecondsAllowed = 10;

long lineCount(const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
}

// A child that can be signalled; stderr goes to a file.
struct Child {
    pid_t pid = -1;

    Child(const std::vector<std::string>& arguments, const std::string& errPath,
          rlim_t fileBytesAllowed = RLIM_INFINITY) {
        std::vector<char*> argv = {const_cast<char*>(PHAT_PROGRAM)};
        for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
        argv.push_back(nullptr);
        pid = fork();
        if (pid != 0) return;
        dup2(open(errPath.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
        dup2(open("/dev/null", O_WRONLY), STDOUT_FILENO);
        const rlimit limit{fileBytesAllowed, fileBytesAllowed};
        setrlimit(RLIMIT_FSIZE, &limit);
        execv(PHAT_PROGRAM, argv.data());
        _exit(127);
    }
    int wait() const {
        int status = 0;
        waitpid(pid, &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
};

// For at most five minutes: a guard against hanging.
bool waitUntil(const std::function<bool()>& condition) {
    for (int i = 0; i < 60'000; ++i) {
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

// Thousands of loose squares need a texel each, whatever their size; a floor takes what it is given.
TEST(ConductBake, SaysWhereAResolutionCannotBeKept) {
    const TemporaryFolder folder;
    const auto noteOf = [&](const Scene& scene, const std::vector<std::string>& more) {
        test::writeGltf(folder.file("a.gltf"), scene);
        std::vector<std::string> arguments = {"bake",     folder.file("a.gltf"),
                                              "-o",       folder.file("a.phat.glb"),
                                              "--json",   "--photons",
                                              "1k",       "--paths",
                                              "1",        "--bounces",
                                              "1",        "--sky",
                                              "sun=0,60", "--probes",
                                              "none"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ProgramResult result = runPhat(arguments);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        const auto report = nlohmann::json::parse(result.out, nullptr, false);
        std::string found;
        for (const std::string note : report["notes"])
            if (note.find("that were asked for") != std::string::npos) found = note;
        const uint64_t made =
            report["atlas"]["width"].get<uint64_t>() * report["atlas"]["height"].get<uint64_t>();
        if (!found.empty()) {
            EXPECT_NE(found.find("the atlas has " + std::to_string(made) + " texels, "), std::string::npos);
        }
        return std::pair(found, made);
    };
    Scene floor;
    test::addFloor(floor, test::lambert(0.5f), 4);
    const auto [kept, keptTexels] = noteOf(floor, {"--resolution", "30k"});
    EXPECT_EQ(kept, "") << keptTexels;
    EXPECT_NEAR(double(keptTexels), 30'000, 3000);

    Scene loose;
    Rng rng(1);
    for (int i = 0; i < 6000; ++i) {
        const glm::vec3 at(20 * rng.uniform(), 20 * rng.uniform(), 20 * rng.uniform());
        const glm::vec3 along = squareToHemisphere(rng.uniform2());
        test::addQuad(loose, test::lambert(0.5f), at, along, frameFromNormal(along).tangent);
    }
    const auto [many, manyTexels] = noteOf(loose, {"--resolution", "4k"});
    EXPECT_NE(many.find("and not the 4000 that were asked for: its "), std::string::npos) << many;
    EXPECT_GT(manyTexels, 4400u);
    EXPECT_EQ(noteOf(loose, {"--texel-size", "0.3"}).first, "") << "nothing was asked for";
}

TEST(ConductBake, RefusesWrongUsage) {
    const TemporaryFolder folder;
    const std::vector<std::vector<std::string>> wrong = {
        {"--samples", "0"},          {"--texel-size", "-1"},    {"--resolution", "12x"},
        {"--directions", "up"},      {"--photons", "nan"},      {"--memory-limit", "0"},
        {"--threads", "0"},          {"--gutter", "x"},         {"--texel-size", ".1"},
        {"--no-such-flag"},          {"--use-uv", "7"},         {"--seed", "-1"},
        {"--glossy-density", "0.5"}, {"--glossy-density", "9"}, {"--glossy-density", "nan"},
        {"--storage", "half"}};
    for (const auto& arguments : wrong) {  // --texel-size beside --resolution
        const auto result = runPhat(smallBake(folder.file("out.glb"), arguments));
        EXPECT_EQ(result.exitCode, 2) << arguments[0] << result.err;
        EXPECT_EQ(lineCount(result.err), 1) << result.err;
    }
    EXPECT_EQ(runPhat({"bake", kScene, "-o", kScene}).exitCode, 2);
    EXPECT_EQ(folder.fileCount(), 0u);
}

TEST(ConductBake, ChecksTheOutputBeforeItBakes) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.path / "folder.glb");
    const auto intoFolder = runPhat(smallBake(folder.file("folder.glb")));
    EXPECT_EQ(intoFolder.exitCode, 1);
    EXPECT_EQ(intoFolder.err, "phat: " + folder.file("folder.glb") + ": is a folder\n");
    const auto picture = runPhat(smallBake(folder.file("out.png")));
    EXPECT_EQ(picture.exitCode, 2);
    EXPECT_NE(picture.err.find(".glb"), std::string::npos) << picture.err;

    const std::string input = folder.file("in.glb"), link = folder.file("link.glb");
    std::filesystem::copy_file(kScene, input);
    std::filesystem::create_symlink(input, link);
    EXPECT_EQ(runPhat({"bake", input, "-o", link}).exitCode, 2);
    EXPECT_EQ(readBytes(input), readBytes(kScene));
    EXPECT_EQ(folder.fileCount(), 3u);
}

TEST(ConductBake, SaysThatTheDiskIsFullAndKeepsWhatIsFinished) {
    const TemporaryFolder folder;
    const std::string out = folder.file("out.glb"), err = folder.file("err");
    const rlim_t kBytesAllowed = 60'000;  // a part of the journal, but neither all parts nor the baked file
    const Child child(smallBake(out, {"--quiet"}), err, kBytesAllowed);
    EXPECT_EQ(child.wait(), 1);
    const auto bytes = readBytes(err);
    const std::string said(bytes.begin(), bytes.end());
    EXPECT_EQ(lineCount(said), 1) << said;
    EXPECT_NE(said.find("cannot be written"), std::string::npos) << said;
    EXPECT_NE(said.find("--resume"), std::string::npos) << said;
    EXPECT_EQ(folder.fileCount(), 2u);  // err and the journal: no half-written file
    ASSERT_EQ(runPhat(smallBake(out, {"--resume", "--quiet"})).exitCode, 0);
    EXPECT_FALSE(std::filesystem::exists(out + ".journal"));
}

// What one storage has finished is not another's: the journal is of other settings, and the bake starts anew.
TEST(ConductBake, ResumesInTheSameStorageAlone) {
    const TemporaryFolder folder;
    const std::string out = folder.file("out.glb"), err = folder.file("err");
    const rlim_t kBytesAllowed = 60'000;  // a part of the journal
    for (const char* resumedAs : {"packed", "paper"}) {
        const Child child(smallBake(out, {"--quiet"}), err, kBytesAllowed);
        ASSERT_EQ(child.wait(), 1);
        ASSERT_TRUE(std::filesystem::exists(out + ".journal"));
        const auto resumed = runPhat(smallBake(out, {"--resume", "--json", "--storage", resumedAs}));
        ASSERT_EQ(resumed.exitCode, 0) << resumed.err;
        const int parts = nlohmann::json::parse(resumed.out)["resumedParts"];
        EXPECT_EQ(parts > 0, std::string(resumedAs) == "packed") << parts;
        const std::string whole = folder.file("whole.glb");
        ASSERT_EQ(runPhat(smallBake(whole, {"--quiet", "--storage", resumedAs})).exitCode, 0);
        EXPECT_EQ(readBytes(out), readBytes(whole)) << resumedAs;
        std::filesystem::remove(out);
    }
}

// What a terminal of 80 columns receives.
TEST(ConductBake, RedrawsOneLineOnATerminal) {
    const TemporaryFolder folder;
    std::vector<std::string> arguments = smallBake(folder.file("out.glb"));
    std::vector<char*> argv = {const_cast<char*>(PHAT_PROGRAM)};
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    winsize size{};
    size.ws_row = 25;
    size.ws_col = 80;
    int terminal = -1;
    const pid_t pid = forkpty(&terminal, nullptr, nullptr, &size);
    if (pid == 0) {
        execv(PHAT_PROGRAM, argv.data());
        _exit(127);
    }
    std::string received;
    char buffer[4096];
    for (ssize_t count; (count = read(terminal, buffer, sizeof(buffer))) > 0;)
        received.append(buffer, size_t(count));
    int status = 0;
    waitpid(pid, &status, 0);
    close(terminal);
    ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << received;

    // Up to the report, carriage returns only; and then nothing of the line is left.
    const std::string kErase = "\x1b[K";
    const size_t report = received.find(folder.file("out.glb"));
    ASSERT_NE(report, std::string::npos) << received;
    const std::string progress = received.substr(0, report);
    EXPECT_EQ(progress.find('\n'), std::string::npos);
    EXPECT_TRUE(progress.ends_with("\r" + kErase));
    size_t redraws = 0, longest = 0;
    for (size_t at = 0; at < progress.size(); ++redraws) {
        const size_t end = std::min(progress.find('\r', at), progress.size());
        longest = std::max(longest, end - at);
        at = end + 1;
    }
    EXPECT_GT(redraws, 8u);
    EXPECT_LT(longest, 80 + kErase.size());
    EXPECT_NE(progress.find("indirect light"), std::string::npos);
}

TEST(ConductBake, RefusesMoreMemoryThanAllowed) {
    const TemporaryFolder folder;
    const Stopwatch start;
    const auto result = runPhat(
        {"bake", kScene, "-o", folder.file("out.glb"), "--resolution", "400M", "--memory-limit", "2"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_EQ(lineCount(result.err), 1) << result.err;
    EXPECT_NE(result.err.find("GB"), std::string::npos);
    EXPECT_LT(start.seconds(), 100);  // a guard: it is refused before anything is allocated
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

TEST(ConductBake, StopsSoonAndGoesOnWhereItWas) {
    const TemporaryFolder folder;
    const std::string out = folder.file("out.glb"), journal = out + ".journal", err = folder.file("err");
    ASSERT_EQ(runPhat(slowBake(folder.file("whole.glb"), {"--quiet"})).exitCode, 0);

    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const Child child(slowBake(out, {"--quiet", "--resume"}), err);
        const size_t before = readBytes(journal).size();
        ASSERT_TRUE(waitUntil([&] { return readBytes(journal).size() > before + 9000; }));
        const Stopwatch start;
        kill(child.pid, signal);
        EXPECT_EQ(child.wait(), 130);
        EXPECT_LT(start.seconds(), kStopSecondsAllowed);
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
TEST(ConductBake, StopsSoonInsideALongPart) {
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
    const Stopwatch start;
    kill(child.pid, SIGINT);
    EXPECT_EQ(child.wait(), 130);
    EXPECT_LT(start.seconds(), kStopSecondsAllowed);
    EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace phat
