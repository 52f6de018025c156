#include "io/base/atomic_file.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

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

[[noreturn]] void failToWrite(const std::string& path, int reason) {
    throw FileError(path, fmt::format("cannot be written: {}", std::strerror(reason)));
}

// Temporary files are TARGET.tmp-PROCESS-ATTEMPT. The process id keeps two programs apart that write the same
// file, O_EXCL two threads.
constexpr const char* kTemporary = ".tmp-";

std::string temporaryName(const std::string& target, int attempt) {
    return nameBeside(target, fmt::format("{}{}-{}", kTemporary, getpid(), attempt));
}

// The process of a temporary file of `target`; 0: it is none.
pid_t writerOf(const std::string& name, const std::string& target) {
    const size_t at = name.rfind(kTemporary);
    if (at == std::string::npos || nameBeside(target, name.substr(at)) != name) return 0;
    int process = 0, attempt = 0, length = 0;
    if (std::sscanf(name.c_str() + at, ".tmp-%d-%d%n", &process, &attempt, &length) != 2) return 0;
    return at + size_t(length) == name.size() && process > 0 ? process : 0;
}

// A new file that a process with another view of the process ids, on a shared folder, can see is in use.
class TemporaryFile {
  public:
    TemporaryFile(const std::string& target, const std::string& path) {
        constexpr int kAttempts = 100;
        for (int attempt = 0; attempt < kAttempts; ++attempt) {
            name_ = temporaryName(target, attempt);
            file_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            if (file_ >= 0) {
                flock(file_, LOCK_EX | LOCK_NB);  // where there are no locks, the process id has to do
                return;
            }
            if (errno != EEXIST) failToWrite(path, errno);
        }
        throw FileError(path, "cannot be written: too many unfinished files beside it");
    }
    ~TemporaryFile() {
        if (!renamed_) unlink(name_.c_str());
        close(file_);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    const std::string& name() const { return name_; }
    bool renameTo(const std::string& target) {
        renamed_ = std::rename(name_.c_str(), target.c_str()) == 0;
        return renamed_;
    }

  private:
    std::string name_;
    int file_ = -1;
    bool renamed_ = false;
};

bool isInUse(const std::string& temporary) {
    const int file = open(temporary.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (file < 0) return true;
    struct stat status {};
    const bool free =
        fstat(file, &status) == 0 && S_ISREG(status.st_mode) && flock(file, LOCK_EX | LOCK_NB) == 0;
    close(file);
    return !free;
}

// What runs that were killed have left: no process has the number in the name, nor a lock on the file. Not by
// std::filesystem, in which libstdc++ ends the program where memory runs out.
void removeStale(const std::string& target) {
    const std::filesystem::path folder = std::filesystem::path(target).parent_path();
    const std::unique_ptr<DIR, int (*)(DIR*)> entries(opendir(folder.empty() ? "." : folder.c_str()),
                                                      closedir);
    if (!entries) return;
    while (const dirent* entry = readdir(entries.get())) {
        if (!std::strstr(entry->d_name, kTemporary)) continue;  // most of a large folder
        const std::string name = (folder / entry->d_name).string();
        const pid_t writer = writerOf(name, target);
        const bool gone = writer > 0 && kill(writer, 0) != 0 && errno == ESRCH;
        if (gone && !isInUse(name)) unlink(name.c_str());
    }
}

// Without this a power cut after the rename may leave an empty file under the final name.
void flushToDisk(const std::string& temporary, const std::string& path) {
    const int file = open(temporary.c_str(), O_RDONLY | O_CLOEXEC);
    const bool flushed = file >= 0 && fsync(file) == 0;
    const int reason = errno;
    if (file >= 0) close(file);
    if (!flushed) failToWrite(path, reason);
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
    removeStale(target);
    TemporaryFile temporary(target, path);
    write(temporary.name());
    keepMode(target, temporary.name());
    flushToDisk(temporary.name(), path);
    if (!temporary.renameTo(target)) failToWrite(path, errno);
}

void checkReplaceable(const std::string& path) {
    const TemporaryFile tried(resolveTarget(path), path);
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
        if (!written) failToWrite(path, reason);
    });
}

}  // namespace phat
