// Broken and unusual files through the whole program: bake, then draw what was baked.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "io/image/image_file.h"
#include "support/run_program.h"

namespace phat {
namespace {

namespace fs = std::filesystem;

// Guards against hanging. Most files take a second; software OpenGL compiles the shaders of a clear coat for
// up to 12 s of processor time, and a sanitizer makes the program about ten times as slow.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr rlim_t kSecondsAllowed = 1200;
#else
constexpr rlim_t kSecondsAllowed = 120;
#endif
constexpr unsigned kClockSecondsAllowed = 1800;  // of a program that hangs without working
constexpr long kKilobytesAllowed = 1'000'000;

// The larger collection beside the repository when it is there, else the copies in tests/data.
fs::path collection(const std::string& name) {
    const fs::path beside = fs::path(PHAT_SOURCE_DIR) / ".." / "shared" / name;
    return fs::exists(beside) ? beside : fs::path(PHAT_SOURCE_DIR) / "tests" / "data" / name;
}

// Runs phat with a time limit; expects that neither a signal nor the limit on memory is met.
ProgramResult runLimited(const std::vector<std::string>& arguments, const TemporaryFolder& folder) {
    const std::string errPath = folder.file("err");
    std::vector<char*> argv = {const_cast<char*>(PHAT_PROGRAM)};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const pid_t pid = fork();
    if (pid == 0) {
        dup2(open(errPath.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
        dup2(open("/dev/null", O_WRONLY), STDOUT_FILENO);
        const rlimit limit{kSecondsAllowed, kSecondsAllowed};
        setrlimit(RLIMIT_CPU, &limit);
        alarm(kClockSecondsAllowed);
        execv(PHAT_PROGRAM, argv.data());
        _exit(127);
    }
    int status = 0;
    rusage used{};
    EXPECT_EQ(wait4(pid, &status, 0, &used), pid);
    EXPECT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
    EXPECT_LT(used.ru_maxrss, kKilobytesAllowed);
    const auto err = readBytes(errPath);
    fs::remove(errPath);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, "", {err.begin(), err.end()}};
}

void expectFinite(const std::string& path) {
    const Image image = readExr(path);
    ASSERT_FALSE(image.pixels.empty());
    for (const glm::vec3& pixel : image.pixels) ASSERT_TRUE(std::isfinite(pixel.x + pixel.y + pixel.z));
}

// Bakes and draws `input`; returns what became of the bake.
ProgramResult bakeAndRender(const fs::path& input) {
    SCOPED_TRACE(input.filename().string());
    const TemporaryFolder folder;
    const std::string baked = folder.file("baked.glb"), picture = folder.file("picture.exr");
    const auto bake = runLimited({"bake", input, "-o", baked, "--resolution", "2k", "--photons", "2k",
                                  "--paths", "1", "--bounces", "4", "--quiet"},
                                 folder);
    if (bake.exitCode != 0) {
        EXPECT_EQ(bake.exitCode, 1) << bake.err;
        const std::string start = "phat: " + input.string() + ": ";
        EXPECT_EQ(bake.err.rfind(start, 0), 0u) << bake.err;
        EXPECT_GT(bake.err.size(), start.size() + 5) << bake.err;
        EXPECT_EQ(std::count(bake.err.begin(), bake.err.end(), '\n'), 1) << bake.err;
        EXPECT_EQ(folder.fileCount(), 0u);
        return bake;
    }
    EXPECT_EQ(bake.err, "");
    EXPECT_EQ(folder.fileCount(), 1u);
    const auto render =
        runLimited({"render", baked, "-o", picture, "--size", "48x32", "--spp", "1", "--quiet"}, folder);
    EXPECT_EQ(render.exitCode, 0) << render.err;
    EXPECT_EQ(render.err, "");
    if (render.exitCode == 0) expectFinite(picture);
    return bake;
}

TEST(ConductFiles, BrokenFilesKeepToTheManifest) {
    const fs::path folder = collection("broken");
    std::ifstream manifest(folder / "MANIFEST.tsv");
    std::string line;
    std::getline(manifest, line);  // titles
    int files = 0;
    for (; std::getline(manifest, line); ++files) {
        std::istringstream columns(line);
        std::string name, what, expected;
        std::getline(columns, name, '\t');
        std::getline(columns, what, '\t');
        std::getline(columns, expected, '\t');
        // A camera that cannot be is left out; the manifest is older than that.
        if (name == "85-camera-zero-fov.glb") expected = "tolerate";
        const int exitCode = bakeAndRender(folder / name).exitCode;
        EXPECT_FALSE(expected == "reject" && exitCode != 1) << line;
        EXPECT_FALSE(expected == "tolerate" && exitCode != 0) << line;
    }
    EXPECT_GT(files, 40);
}

TEST(ConductFiles, UnusualFilesAreBakedUnlessTheyHaveNoTriangles) {
    const std::set<std::string> empty = {"Mesh_PrimitiveMode_00.glb", "Mesh_PrimitiveMode_02.glb"};
    int files = 0;
    for (const auto& entry : fs::directory_iterator(collection("loader"))) {
        if (entry.path().extension() != ".glb") continue;
        ++files;
        const bool isEmpty = empty.contains(entry.path().filename());
        const auto bake = bakeAndRender(entry.path());
        EXPECT_EQ(bake.exitCode, isEmpty ? 1 : 0) << entry.path();
        if (!isEmpty) continue;
        EXPECT_NE(bake.err.find("no triangles"), std::string::npos) << bake.err;
        EXPECT_EQ(runPhat({"info", entry.path()}).exitCode, 0) << entry.path();
    }
    EXPECT_GT(files, 15);
}

}  // namespace
}  // namespace phat
