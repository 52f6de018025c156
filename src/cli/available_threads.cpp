#include "cli/available_threads.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <latch>
#include <system_error>
#include <thread>
#include <vector>

namespace phat {

std::optional<tbb::global_control> useAvailableThreads() {
    const int wanted = tbb::this_task_arena::max_concurrency();
    std::latch done(1);
    std::vector<std::jthread> threads;  // at the same time, which is what a limit counts
    std::string reason;
    try {
        for (int i = 0; i < std::max(wanted - 1, 1); ++i) threads.emplace_back([&done] { done.wait(); });
    } catch (const std::system_error& error) {
        reason = error.code().message();
    }
    done.count_down();
    if (threads.empty()) throw std::runtime_error(fmt::format("no threads can be started: {}", reason));
    if (reason.empty()) return std::nullopt;
    return std::optional<tbb::global_control>(std::in_place, tbb::global_control::max_allowed_parallelism,
                                              threads.size() + 1);
}

}  // namespace phat
