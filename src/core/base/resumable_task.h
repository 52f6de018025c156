#pragma once
// Long work that stops between its slices, so that other work can go on meanwhile.

#include <coroutine>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <utility>

namespace phat {

/// A coroutine that yields the cost of each slice, in rays or their equivalent in time. What its arguments
/// refer to must outlive it. Exceptions come out of next().
class ResumableTask {
  public:
    struct promise_type {
        uint64_t work = 0;
        std::exception_ptr failure;

        ResumableTask get_return_object() { return ResumableTask(Handle::from_promise(*this)); }
        std::suspend_always initial_suspend() noexcept { return {}; }
        std::suspend_always final_suspend() noexcept { return {}; }
        std::suspend_always yield_value(uint64_t done) noexcept {
            work = done;
            return {};
        }
        void return_void() noexcept {}
        void unhandled_exception() { failure = std::current_exception(); }
    };

    ResumableTask(ResumableTask&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
    ResumableTask& operator=(ResumableTask&& other) noexcept {
        std::swap(handle_, other.handle_);
        return *this;
    }
    ~ResumableTask() {
        if (handle_) handle_.destroy();
    }

    /// Runs the next slice. Returns false once the task has ended, and does nothing from then on.
    bool next() {
        if (handle_.done()) return false;
        handle_.resume();
        if (handle_.promise().failure)
            std::rethrow_exception(std::exchange(handle_.promise().failure, nullptr));
        return !handle_.done();
    }
    /// Of the last slice.
    uint64_t work() const { return handle_.promise().work; }

  private:
    using Handle = std::coroutine_handle<promise_type>;
    explicit ResumableTask(Handle handle) : handle_(handle) {}
    Handle handle_;
};

/// Does all of it.
inline void finish(ResumableTask slices) {
    while (slices.next()) {
    }
}

/// Work between two yields, in rays or their equivalent in time. A bake does not slice.
inline constexpr uint64_t kNoSlicing = ~uint64_t(0);

/// Items of a slice, each of which takes `itemWork`.
inline size_t itemsPerSlice(uint64_t pieceWork, uint64_t itemWork) {
    return pieceWork == kNoSlicing ? ~size_t(0) : size_t(pieceWork / itemWork + 1);
}

}  // namespace phat
