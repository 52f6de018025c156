#pragma once
// Runs the phat program on files that may make it hang, or take all memory.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/run_program.h"

namespace phat {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr int kSanitizerFactor = 10;  // in time, and in memory a few times
#else
inline constexpr int kSanitizerFactor = 1;
#endif

struct Limits {
    int processorSeconds = 120;
    int megabytes = 1000;
    unsigned clockSeconds = 1800;  // of a program that hangs without working
};

/// Expects that neither a signal nor the limit on memory is met. May be called from several threads.
inline ProgramResult runLimited(const std::vector<std::string>& arguments, const Limits& limits = {}) {
    const TemporaryFolder folder;
    const std::string out = folder.file("out"), err = folder.file("err");
    std::vector<char*> argv = {const_cast<char*>(PHAT_PROGRAM)};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const rlim_t seconds = rlim_t(limits.processorSeconds) * kSanitizerFactor;
    const pid_t pid = fork();
    if (pid == 0) {
        dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
        dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
        const rlimit limit{seconds, seconds};
        setrlimit(RLIMIT_CPU, &limit);
        alarm(limits.clockSeconds);
        execv(PHAT_PROGRAM, argv.data());
        _exit(127);
    }
    int status = 0;
    rusage used{};
    EXPECT_EQ(wait4(pid, &status, 0, &used), pid);
    EXPECT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
    EXPECT_LT(used.ru_maxrss, 1000l * limits.megabytes * kSanitizerFactor);
    const auto text = [](const std::string& path) {
        const auto bytes = readBytes(path);
        return std::string(bytes.begin(), bytes.end());
    };
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text(out), text(err)};
}

/// The larger collection beside the repository when it is there, else the copies in tests/data.
inline std::filesystem::path collection(const std::string& name) {
    const auto source = std::filesystem::path(PHAT_SOURCE_DIR);
    const auto beside = source / ".." / "shared" / name;
    return std::filesystem::exists(beside) ? beside : source / "tests/data" / name;
}

}  // namespace phat
