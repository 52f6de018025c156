#include "io/base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "io/base/file_error.h"

namespace phat {
namespace {

// Where the bytes end up: renaming onto a link would replace the link, and onto a device the device.
std::string resolveTarget(const std::string& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (std::filesystem::is_directory(status)) throw FileError(path, "is a folder");
    if (!std::filesystem::exists(status)) return path;
    if (!std::filesystem::is_regular_file(status)) throw FileError(path, "is not a regular file");
    if (!std::filesystem::is_symlink(path, error)) return path;
    const auto target = std::filesystem::canonical(path, error);
    return error ? path : target.string();
}

// The process id keeps two programs apart that write the same file, O_EXCL two threads.
std::string createBeside(const std::string& target, const std::string& path) {
    constexpr int kAttempts = 100;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        const std::string name = fmt::format("{}.tmp-{}-{}", target, getpid(), attempt);
        const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file >= 0) {
            close(file);
            return name;
        }
        if (errno != EEXIST)
            throw FileError(path, fmt::format("cannot be written: {}", std::strerror(errno)));
    }
    throw FileError(path, "cannot be written: too many unfinished files beside it");
}

// Without this a power cut after the rename may leave an empty file under the final name.
void flushToDisk(const std::string& temporary, const std::string& path) {
    const int file = open(temporary.c_str(), O_RDONLY | O_CLOEXEC);
    const bool flushed = file >= 0 && fsync(file) == 0;
    const int reason = errno;
    if (file >= 0) close(file);
    if (!flushed) throw FileError(path, fmt::format("cannot be written: {}", std::strerror(reason)));
}

}  // namespace

void replaceFile(const std::string& path, const std::function<void(const std::string&)>& write) {
    const std::string target = resolveTarget(path);
    const std::string temporary = createBeside(target, path);
    try {
        write(temporary);
        flushToDisk(temporary, path);
        if (std::rename(temporary.c_str(), target.c_str()) != 0)
            throw FileError(path, fmt::format("cannot be written: {}", std::strerror(errno)));
    } catch (...) {
        unlink(temporary.c_str());
        throw;
    }
}

void checkReplaceable(const std::string& path) {
    unlink(createBeside(resolveTarget(path), path).c_str());
}

void replaceFile(const std::string& path, std::span<const uint8_t> bytes) {
    replaceFile(path, [&](const std::string& temporary) {
        std::FILE* file = std::fopen(temporary.c_str(), "wb");
        bool written = file && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
        int reason = errno;
        // Buffered bytes may fail only here, on a full disk.
        if (file && std::fclose(file) != 0 && written) {
            written = false;
            reason = errno;
        }
        if (!written) throw FileError(path, fmt::format("cannot be written: {}", std::strerror(reason)));
    });
}

}  // namespace phat
