#include "io/phat/bake_journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <mutex>
#include <unordered_map>

#include "core/base/random.h"
#include "io/base/file_error.h"
#include "io/base/plain_file.h"
#include "io/gltf/gltf_json.h"
#include "io/gltf/gltf_light_profiles.h"
#include "io/gltf/gltf_source.h"

namespace phat {
namespace {

constexpr uint32_t kJournalVersion = 1;

struct Header {
    char magic[8] = {'P', 'H', 'A', 'T', 'J', 'R', 'N', 'L'};
    uint32_t version = kJournalVersion;
    uint32_t reserved = 0;
    uint64_t fingerprint = 0;
};

struct RecordHeader {
    uint64_t key = 0;
    uint32_t length = 0;
    uint32_t checksum = 0;
};

// A part of a stage is some kilobytes; a length beyond this is damage.
constexpr uint32_t kMaxRecordBytes = 256u << 20;

uint32_t checksumOf(const RecordHeader& record, std::span<const uint8_t> bytes) {
    const uLong crc = crc32_z(0, reinterpret_cast<const Bytef*>(&record), offsetof(RecordHeader, checksum));
    // zlib takes a null pointer for a request of the initial value.
    return uint32_t(bytes.empty() ? crc : crc32_z(crc, bytes.data(), bytes.size()));
}

bool readFully(int file, void* to, size_t size, uint64_t offset) {
    auto* bytes = static_cast<uint8_t*>(to);
    while (size > 0) {
        const ssize_t got = pread(file, bytes, size, off_t(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        bytes += got;
        offset += uint64_t(got);
        size -= size_t(got);
    }
    return true;
}

bool writeFully(int file, const void* from, size_t size, uint64_t offset) {
    const auto* bytes = static_cast<const uint8_t*>(from);
    while (size > 0) {
        const ssize_t put = pwrite(file, bytes, size, off_t(offset));
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return false;
        bytes += put;
        offset += uint64_t(put);
        size -= size_t(put);
    }
    return true;
}

}  // namespace

void addGltf(Fingerprint& fingerprint, const GltfSource& source) {
    try {
        fingerprint.add(source.json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
        for (const auto& buffer : source.buffers) fingerprint.add(buffer);
        const auto addFilesOf = [&](const nlohmann::json& items) {
            for (const nlohmann::json& item : items) {
                if (!item.contains("uri")) continue;
                try {
                    fingerprint.add(readGltfUri(source, item["uri"].get<std::string>()));
                } catch (const std::runtime_error&) {
                    // The loader goes on without a picture or a light that it cannot read, and says so.
                }
            }
        };
        addFilesOf(source.json.value("images", nlohmann::json::array()));
        if (const nlohmann::json* profiles = gltf::findExtension(source.json, gltf::kLightProfiles))
            addFilesOf(profiles->value("lights", nlohmann::json::array()));
    } catch (const std::exception& error) {
        throw FileError(source.path, error.what());
    }
}

void addFile(Fingerprint& fingerprint, const std::string& path) {
    requirePlainFile(path);
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (!file) throw FileError(path, "cannot be read");
    fingerprint.add(text);
}

namespace {

[[noreturn]] void failOn(const std::string& path, const char* what) {
    throw FileError(path, fmt::format("{}: {}", what, std::strerror(errno)));
}

// Of a file that may be cut off: what is there agrees.
bool beginsAsJournal(int file) {
    struct stat status {};
    if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) return false;
    const Header expected;
    char magic[sizeof(expected.magic)];
    const size_t size = std::min(sizeof(magic), size_t(status.st_size));
    return readFully(file, magic, size, 0) && std::memcmp(magic, expected.magic, size) == 0;
}

// What is there if it is a journal, or a new file. Whatever else has this name is not touched, nor what a
// link leads to.
int openJournal(const std::string& path) {
    int file = open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (file < 0 && errno == ENOENT)
        file = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (file < 0 && errno != ELOOP) failOn(path, "cannot be written");
    if (file >= 0 && beginsAsJournal(file)) return file;
    if (file >= 0) close(file);
    throw FileError(path, "is in the way of the bake's journal, and is no journal itself");
}

int lockedJournal(const std::string& path) {
    const int file = openJournal(path);
    if (flock(file, LOCK_EX | LOCK_NB) == 0) return file;
    close(file);
    throw FileError(path, "is in use by another bake");
}

}  // namespace

struct FileJournal::State {
    struct Extent {
        uint64_t offset;
        uint32_t length;
    };
    std::string path;
    int file = -1;
    uint64_t end = 0;
    std::unordered_map<uint64_t, Extent> records;
    size_t resumed = 0;
    std::mutex mutex;

    ~State() {
        if (file >= 0) close(file);
    }

    [[noreturn]] void fail(const char* what) const { failOn(path, what); }

    // An earlier run's file that this one has no use for; a new one takes its place.
    void putAside() {
        const std::string aside = path + ".old";
        close(openJournal(aside));  // nothing but an older journal is replaced
        if (std::rename(path.c_str(), aside.c_str()) != 0) fail("cannot be put aside");
        close(file);
        file = lockedJournal(path);
        end = 0;
    }

    bool holdsRecords() const {
        struct stat status {};
        return fstat(file, &status) == 0 && status.st_size > off_t(sizeof(Header));
    }

    // Takes over what an earlier run has left; false where that is nothing, or of another bake.
    bool readRecords(uint64_t fingerprint) {
        Header header;
        const Header expected{.fingerprint = fingerprint};
        if (!readFully(file, &header, sizeof(header), 0)) return false;
        if (std::memcmp(&header, &expected, sizeof(header)) != 0) return false;
        struct stat status {};
        if (fstat(file, &status) != 0) return false;
        end = sizeof(Header);
        std::vector<uint8_t> bytes;
        for (RecordHeader record; readFully(file, &record, sizeof(record), end);) {
            const uint64_t left = uint64_t(status.st_size) - end - sizeof(record);
            if (record.length > left || record.length > kMaxRecordBytes) break;
            bytes.resize(record.length);
            if (!readFully(file, bytes.data(), bytes.size(), end + sizeof(record))) break;
            if (checksumOf(record, bytes) != record.checksum) break;
            records[record.key] = {end + sizeof(record), record.length};
            end += sizeof(record) + record.length;
        }
        return true;
    }
};

FileJournal::FileJournal(const std::string& path, uint64_t fingerprint, bool resume)
    : state_(std::make_unique<State>()) {
    State& s = *state_;
    s.path = path;
    s.file = lockedJournal(path);
    if (!resume || !s.readRecords(fingerprint)) {
        s.records.clear();
        if (s.holdsRecords()) {
            s.putAside();
            putAside_ = path + ".old";
        }
        const Header header{.fingerprint = fingerprint};
        if (ftruncate(s.file, 0) != 0 || !writeFully(s.file, &header, sizeof(header), 0)) {
            const int reason = errno;
            remove();  // nothing is in it
            errno = reason;
            s.fail("cannot be written");
        }
        s.end = sizeof(Header);
    }
    if (ftruncate(s.file, off_t(s.end)) != 0) s.fail("cannot be written");
    s.resumed = s.records.size();
}

FileJournal::~FileJournal() = default;

std::vector<uint8_t> FileJournal::load(uint64_t key) {
    State::Extent extent;
    {
        const std::lock_guard lock(state_->mutex);
        const auto found = state_->records.find(key);
        if (found == state_->records.end()) return {};
        extent = found->second;
    }
    std::vector<uint8_t> bytes(extent.length);
    if (!readFully(state_->file, bytes.data(), bytes.size(), extent.offset)) return {};
    return bytes;
}

void FileJournal::store(uint64_t key, const std::vector<uint8_t>& bytes) {
    RecordHeader record{key, uint32_t(bytes.size()), 0};
    record.checksum = checksumOf(record, bytes);
    const std::lock_guard lock(state_->mutex);
    State& s = *state_;
    if (!writeFully(s.file, &record, sizeof(record), s.end) ||
        !writeFully(s.file, bytes.data(), bytes.size(), s.end + sizeof(record)) || fdatasync(s.file) != 0)
        s.fail("cannot be written");
    s.records[key] = {s.end + sizeof(record), record.length};
    s.end += sizeof(record) + record.length;
}

size_t FileJournal::resumedRecords() const {
    return state_->resumed;
}

bool FileJournal::empty() const {
    return state_->records.empty();
}

void FileJournal::remove() {
    unlink(state_->path.c_str());
}

}  // namespace phat
