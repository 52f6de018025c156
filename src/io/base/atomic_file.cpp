#include "io/base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "io/base/file_error.h"

namespace phat {
namespace {

// Where the bytes end up: renaming onto a link would replace the link, and onto a device the device. A link
// whose target does not exist yet names the file to make.
std::string resolveTarget(const std::string& path) {
    namespace fs = std::filesystem;
    constexpr int kMaxLinks = 40;  // as Linux allows
    fs::path target = path;
    std::error_code error;
    for (int links = 0; fs::is_symlink(fs::symlink_status(target, error)); ++links) {
        const fs::path next = fs::read_symlink(target, error);
        if (error || links == kMaxLinks) throw FileError(path, "is a link that leads nowhere");
        target = target.parent_path() / next;  // an absolute `next` stands alone
    }
    const auto status = fs::status(target, error);
    if (fs::is_directory(status)) throw FileError(path, "is a folder");
    if (fs::exists(status) && !fs::is_regular_file(status)) throw FileError(path, "is not a regular file");
    return target.string();
}

// The process id keeps two programs apart that write the same file, O_EXCL two threads.
std::string createBeside(const std::string& target, const std::string& path) {
    constexpr int kAttempts = 100;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        const std::string name = nameBeside(target, fmt::format(".tmp-{}-{}", getpid(), attempt));
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

// A file that is written anew stays as readable as it was.
void keepMode(const std::string& target, const std::string& temporary) {
    struct stat old;
    if (stat(target.c_str(), &old) == 0) chmod(temporary.c_str(), old.st_mode & 07777);
}

}  // namespace

std::string nameBeside(const std::string& path, const std::string& suffix) {
    const size_t slash = path.rfind('/');
    const size_t start = slash == std::string::npos ? 0 : slash + 1;
    size_t end = std::min(path.size(), start + NAME_MAX - suffix.size());
    // Not within a character of UTF-8.
    while (end < path.size() && end > start && (uint8_t(path[end]) & 0xc0) == 0x80) --end;
    return path.substr(0, end) + suffix;
}

void replaceFile(const std::string& path, const std::function<void(const std::string&)>& write) {
    const std::string target = resolveTarget(path);
    const std::string temporary = createBeside(target, path);
    try {
        write(temporary);
        keepMode(target, temporary);
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
