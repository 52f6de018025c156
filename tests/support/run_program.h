#pragma once
// Runs the phat program, and others, as a user would.

#include <sys/wait.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace phat {

struct ProgramResult {
    int exitCode = -1;  // -1: ended by a signal
    std::string out;
    std::string err;
};

/// `program`: a path, or a name that the shell looks for.
inline ProgramResult runProgram(const std::string& program, const std::vector<std::string>& arguments) {
    const TemporaryFolder folder;
    const auto quoted = [](const std::string& text) {
        std::string out = "'";
        for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
        return out + "'";
    };
    std::string line = quoted(program);
    for (const std::string& argument : arguments) line += " " + quoted(argument);
    line += " >" + quoted(folder.file("out")) + " 2>" + quoted(folder.file("err"));
    const int status = std::system(line.c_str());
    const auto text = [&](const char* name) {
        const auto bytes = readBytes(folder.file(name));
        return std::string(bytes.begin(), bytes.end());
    };
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text("out"), text("err")};
}

inline ProgramResult runPhat(const std::vector<std::string>& arguments) {
    return runProgram(PHAT_PROGRAM, arguments);
}

}  // namespace phat
