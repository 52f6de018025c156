#pragma once
// Files whose end can be read.

#include <filesystem>
#include <string>

#include "io/base/file_error.h"

namespace phat {

/// Why it is none: devices and pipes have no size and may never end. Empty: it is one.
inline std::string whyNoPlainFile(const std::filesystem::path& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) return "no such file";
    return std::filesystem::is_regular_file(status) ? "" : "not a plain file";
}

/// Throws FileError unless it is one.
inline void requirePlainFile(const std::string& path) {
    if (const std::string reason = whyNoPlainFile(path); !reason.empty()) throw FileError(path, reason);
}

}  // namespace phat
