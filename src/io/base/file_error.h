#pragma once
// The one exception of the outer layers: caught once in main, printed as "phat: FILE: REASON".

#include <stdexcept>
#include <string>

namespace phat {

struct FileError : std::runtime_error {
    FileError(std::string file, std::string why)
        : std::runtime_error(file + ": " + why), path(std::move(file)), reason(std::move(why)) {}
    std::string path;
    std::string reason;
};

}  // namespace phat
