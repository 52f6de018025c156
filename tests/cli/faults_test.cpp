// Memory, disks and threads that fail (tests/faults), and processes that are killed: each command ends with
// one line and exit code 1, leaves nothing, and does not lose what a journal has. PHAT_FAULTS=200 tries so
// many of each kind.

#include "faults/faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/base/random.h"
#include "core/base/stopwatch.h"
#include "support/run_limited.h"

namespace phat {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

const std::string kScene = PHAT_SOURCE_DIR "/fuzz/corpus/gltf/animated.glb";
const std::string kBaked = PHAT_SOURCE_DIR "/fuzz/corpus/baked/room.phat.glb";

size_t faultCount() {
    const char* asked = std::getenv("PHAT_FAULTS");
    return asked ? size_t(std::max(1, std::atoi(asked))) : 3;
}

struct Counts {
    uint64_t allocations = 0, operations = 0;
};

// A command, run again and again in a folder of its own.
class Faults : public testing::Test {
  protected:
    void SetUp() override {
        if (kSanitizerFactor > 1) GTEST_SKIP() << "sanitizers have allocation functions of their own";
    }

    // `fault`: "" for none.
    ProgramResult run(const Arguments& arguments, const std::string& fault) const {
        Arguments line{std::string("LD_PRELOAD=") + PHAT_FAULT_LIBRARY, "MESA_SHADER_CACHE_DISABLE=true",
                       std::string(faults::kCountsVariable) + "=" + countsPath()};
        if (!fault.empty()) line.push_back(std::string(faults::kFaultVariable) + "=" + fault);
        line.push_back(PHAT_PROGRAM);
        line.insert(line.end(), arguments.begin(), arguments.end());
        return runProgram("env", line);
    }

    Counts counted(const Arguments& arguments) const {
        const auto result = run(arguments, "");
        EXPECT_EQ(result.exitCode, 0) << result.err;
        Counts counts;
        std::ifstream(countsPath()) >> counts.allocations >> counts.operations;
        return counts;
    }

    using Files = std::map<std::string, std::vector<char>>;

    Files contents() const {
        Files files;
        for (const auto& entry : fs::recursive_directory_iterator(folder.path))
            files[entry.path()] = entry.is_regular_file() ? readBytes(entry.path()) : std::vector<char>();
        return files;
    }

    void clear() const {
        for (const auto& entry : fs::directory_iterator(folder.path)) fs::remove_all(entry.path());
    }

    // Runs the command with faults evenly spread over `last` places. Where it is not undone by one, nothing
    // differs from a run without. Returns how often it failed.
    size_t tryFaults(const Arguments& arguments, const std::string& kind, uint64_t last) const {
        clear();
        run(arguments, "");
        const auto whole = contents();
        size_t failures = 0;
        const uint64_t tries = std::min<uint64_t>(faultCount(), last);
        for (uint64_t i = 0; i < tries; ++i) {
            clear();
            const std::string fault = kind + ":" + std::to_string(1 + i * last / tries);
            SCOPED_TRACE(arguments.front() + " " + fault);
            const auto result = run(arguments, fault);
            if (result.exitCode == 0) {
                EXPECT_EQ(result.err, "");
                EXPECT_EQ(contents(), whole);
                continue;
            }
            ++failures;
            expectOneLine(result);
            expectNothingLeft(result.err, whole);
        }
        return failures;
    }

    static void expectOneLine(const ProgramResult& result) {
        EXPECT_EQ(result.exitCode, 1) << result.err;
        EXPECT_TRUE(result.err.starts_with("phat: ")) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }

    // But a journal that is spoken of, and whole files of commands that write several.
    void expectNothingLeft(const std::string& said, const Files& whole) const {
        for (const auto& [path, bytes] : contents()) {
            if (path == out("room.phat.glb.journal")) {
                EXPECT_NE(said.find("--resume goes on from " + path), std::string::npos) << said;
                continue;
            }
            const bool ofSeveral = path.starts_with(out("exr")) || path.starts_with(out("lightmap")) ||
                                   path.starts_with(out("site"));
            const auto found = whole.find(path);
            EXPECT_TRUE(ofSeveral && found != whole.end()) << path << " is left\n" << said;
            if (found == whole.end()) continue;
            EXPECT_EQ(bytes, found->second) << path;
        }
    }

    std::string out(const std::string& name) const { return folder.file(name); }
    std::string countsPath() const { return beside.file("counts"); }

    Arguments bake() const {
        return {"bake",         kScene, "-o",       out("room.phat.glb"),
                "--resolution", "64",   "--gutter", "1",
                "--photons",    "2k",   "--probes", "8",
                "--seed",       "3",    "--quiet"};
    }
    Arguments info() const { return {"info", kBaked, "--json"}; }
    Arguments render(const std::string& method) const {
        return {"render", kBaked,  "-o", out("room.png"), "--method", method, "--size",
                "8x8",    "--spp", "1",  "--quiet"};
    }
    Arguments web() const { return {"web", kBaked, "-o", out("site"), "--poster-width", "64", "--quiet"}; }
    Arguments exportExr() const { return {"export", kBaked, "--exr", out("exr")}; }
    Arguments exportLightmap() const {
        return {"export",        kBaked,    "--lightmap", out("lightmap"),
                "--directional", "--light", "all",        "--quiet"};
    }

    TemporaryFolder folder, beside;
};

TEST_F(Faults, MemoryRunsOut) {
    for (const Arguments& arguments : {info(), bake(), render("path"), exportExr(), exportLightmap()})
        EXPECT_GT(tryFaults(arguments, "new", counted(arguments).allocations), 0u) << arguments.front();
}

// OpenGL's driver is no program of ours, and written without exceptions.
TEST_F(Faults, MemoryRunsOutWhereOpenGlDraws) {
    for (const Arguments& arguments : {render("phat"), web()}) {
        run(arguments, "own-new:0");
        Counts counts;
        std::ifstream(countsPath()) >> counts.allocations >> counts.operations;
        EXPECT_GT(tryFaults(arguments, "own-new", counts.allocations), 0u) << arguments.front();
    }
}

TEST_F(Faults, DisksFillUpOrBreak) {
    for (const Arguments& arguments : {bake(), render("path"), exportExr(), exportLightmap(), web()}) {
        const uint64_t operations = counted(arguments).operations;
        EXPECT_GT(operations, 3u);
        for (const char* kind : {"no-space", "broken-disk"})
            EXPECT_GT(tryFaults(arguments, kind, operations), 0u) << arguments.front();
    }
}

TEST_F(Faults, NoThreadsCanBeMade) {
    for (const Arguments& arguments : {info(), bake(), render("path"), render("phat"), web()}) {
        clear();
        const auto result = run(arguments, "no-threads:0");
        expectOneLine(result);
        EXPECT_NE(result.err.find("thread"), std::string::npos) << result.err;
        EXPECT_TRUE(contents().empty());
    }
}

TEST(Killed, GoesOnWhereItWas) {
    const TemporaryFolder folder;
    const std::string whole = folder.file("whole.phat.glb"), out = folder.file("out.phat.glb");
    const auto bake = [&](const std::string& to) -> Arguments {
        return {"bake",         PHAT_SOURCE_DIR "/scenes/cornell-glossy.glb",
                "-o",           to,
                "--resolution", "16k",
                "--photons",    "2k",
                "--probes",     "64",
                "--quiet",      "--resume"};
    };
    const Stopwatch start;
    ASSERT_EQ(runPhat(bake(whole)).exitCode, 0);
    const double seconds = start.seconds();
    Rng rng(21);
    size_t kills = 0;
    for (size_t i = 0; i < faultCount(); ++i) {
        Arguments line{"--signal=KILL", std::to_string(double(rng.uniform()) * seconds), PHAT_PROGRAM};
        const Arguments arguments = bake(out);
        line.insert(line.end(), arguments.begin(), arguments.end());
        if (runProgram("timeout", line).exitCode == 0) {
            EXPECT_EQ(readBytes(out), readBytes(whole));
            fs::remove(out);
        } else {
            ++kills;
            EXPECT_FALSE(fs::exists(out));
        }
    }
    EXPECT_GT(kills, 0u);
    const auto result = runPhat(bake(out));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(readBytes(out), readBytes(whole));
    EXPECT_EQ(folder.fileCount(), 2u);  // neither journals nor unfinished files
}

}  // namespace
}  // namespace phat
