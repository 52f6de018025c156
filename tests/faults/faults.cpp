// Failures of memory, disks and threads on demand: stands in front of the C and C++ libraries (faults.h).

#include "faults/faults.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <pthread.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

using namespace phat::faults;

enum class Kind : uint8_t { none, allAllocations, ownAllocations, noSpace, brokenDisk, noThreads };

struct Range {
    uintptr_t begin = 0, end = 0;
};

Kind kind = Kind::none;
uint64_t number = 0;
std::atomic<uint64_t> allocations{0}, operations{0};
// With the first thread that is made the command line has been read. CLI11, which does that, allocates where
// it must not throw.
std::atomic<bool> begun{false};
Range program;  // its code, without libraries

// The first object that is visited is the program.
int findProgram(dl_phdr_info* info, size_t, void*) {
    for (int i = 0; i < info->dlpi_phnum; ++i) {
        const auto& segment = info->dlpi_phdr[i];
        if (segment.p_type != PT_LOAD || !(segment.p_flags & PF_X)) continue;
        program.begin = info->dlpi_addr + segment.p_vaddr;
        program.end = program.begin + segment.p_memsz;
    }
    return 1;
}

[[gnu::constructor]] void readEnvironment() {
    dl_iterate_phdr(findProgram, nullptr);
    const char* wanted = std::getenv(kFaultVariable);
    if (!wanted) return;
    const char* colon = std::strchr(wanted, ':');
    if (!colon) std::abort();
    for (size_t i = 0; i < std::size(kKinds); ++i)
        if (std::strlen(kKinds[i]) == size_t(colon - wanted) &&
            std::strncmp(kKinds[i], wanted, size_t(colon - wanted)) == 0)
            kind = Kind(i + 1);
    if (kind == Kind::none) std::abort();
    number = std::strtoull(colon + 1, nullptr, 10);
}

template <class Function>
Function realOf(Function, const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

[[gnu::destructor]] void writeCounts() {
    const char* path = std::getenv(kCountsVariable);
    if (!path) return;
    kind = Kind::none;
    std::FILE* file = std::fopen(path, "w");
    if (!file) std::abort();
    std::fprintf(file, "%llu %llu\n", static_cast<unsigned long long>(allocations),
                 static_cast<unsigned long long>(operations));
    std::fclose(file);
}

void* allocate(size_t size, size_t alignment, const void* caller) {
    const auto at = reinterpret_cast<uintptr_t>(caller);
    const bool own = at >= program.begin && at < program.end;
    if (begun && (own || kind != Kind::ownAllocations)) {
        const uint64_t mine = ++allocations;
        if ((kind == Kind::allAllocations || kind == Kind::ownAllocations) && mine == number)
            throw std::bad_alloc();
    }
    if (size == 0) size = 1;
    void* memory = alignment == 0
                       ? std::malloc(size)
                       : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (!memory) throw std::bad_alloc();
    return memory;
}

// The standard streams have tests of their own; pipes and the like are no disk.
bool isOnDisk(int file) {
    struct stat status {};
    return file > STDERR_FILENO && fstat(file, &status) == 0 && S_ISREG(status.st_mode);
}

/// Counts an operation; whether it is to fail, and errno says why.
bool fails(bool needsSpace) {
    const uint64_t mine = ++operations;
    if (kind == Kind::noSpace && needsSpace && mine >= number) {
        errno = ENOSPC;
        return true;
    }
    if (kind == Kind::brokenDisk && mine == number) {
        errno = EIO;
        return true;
    }
    return false;
}

bool failsOnDisk(int file, bool needsSpace = true) {
    return isOnDisk(file) && fails(needsSpace);
}

}  // namespace

void* operator new(size_t size) {
    return allocate(size, 0, __builtin_return_address(0));
}
void* operator new[](size_t size) {
    return allocate(size, 0, __builtin_return_address(0));
}
void* operator new(size_t size, std::align_val_t alignment) {
    return allocate(size, size_t(alignment), __builtin_return_address(0));
}
void* operator new[](size_t size, std::align_val_t alignment) {
    return allocate(size, size_t(alignment), __builtin_return_address(0));
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete[](void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, size_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, size_t, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, size_t, std::align_val_t) noexcept {
    std::free(memory);
}

extern "C" {

ssize_t write(int file, const void* bytes, size_t size) {
    static const auto real = realOf(&write, "write");
    return failsOnDisk(file) ? -1 : real(file, bytes, size);
}

ssize_t writev(int file, const iovec* parts, int count) {
    static const auto real = realOf(&writev, "writev");
    return failsOnDisk(file) ? -1 : real(file, parts, count);
}

ssize_t pwrite(int file, const void* bytes, size_t size, off_t offset) {
    static const auto real = realOf(&pwrite, "pwrite");
    return failsOnDisk(file) ? -1 : real(file, bytes, size, offset);
}

size_t fwrite(const void* bytes, size_t size, size_t count, std::FILE* file) {
    static const auto real = realOf(&fwrite, "fwrite");
    return failsOnDisk(fileno(file)) ? 0 : real(bytes, size, count, file);
}

// Whatever was buffered is lost, and the file is closed nevertheless.
int fclose(std::FILE* file) {
    static const auto real = realOf(&fclose, "fclose");
    const bool failed = (fcntl(fileno(file), F_GETFL) & O_ACCMODE) != O_RDONLY && failsOnDisk(fileno(file));
    const int reason = errno;
    const int result = real(file);
    if (!failed) return result;
    errno = reason;
    return EOF;
}

int fsync(int file) {
    static const auto real = realOf(&fsync, "fsync");
    return failsOnDisk(file) ? -1 : real(file);
}

int fdatasync(int file) {
    static const auto real = realOf(&fdatasync, "fdatasync");
    return failsOnDisk(file) ? -1 : real(file);
}

int ftruncate(int file, off_t size) noexcept {
    static const auto real = realOf(&ftruncate, "ftruncate");
    return failsOnDisk(file, /*needsSpace=*/size > 0) ? -1 : real(file, size);
}

int rename(const char* from, const char* to) noexcept {
    static const auto real = realOf(&rename, "rename");
    return fails(/*needsSpace=*/true) ? -1 : real(from, to);
}

int open(const char* path, int flags, ...) {
    static const auto real = realOf(&open, "open");
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = flags & O_CREAT ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    return flags & O_CREAT && fails(/*needsSpace=*/true) ? -1 : real(path, flags, mode);
}

int mkdir(const char* path, mode_t mode) noexcept {
    static const auto real = realOf(&mkdir, "mkdir");
    return fails(/*needsSpace=*/true) ? -1 : real(path, mode);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*),
                   void* argument) noexcept {
    static const auto real = realOf(&pthread_create, "pthread_create");
    begun = true;
    return kind == Kind::noThreads ? EAGAIN : real(thread, attributes, run, argument);
}

}  // extern "C"
