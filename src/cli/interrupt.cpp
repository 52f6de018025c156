#include "cli/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

namespace phat {
namespace {

// A signal handler can reach nothing but globals.
std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void onSignal(int) {
    if (interrupted.exchange(true)) _exit(130);
}

}  // namespace

void catchInterrupts() {
    struct sigaction action {};
    action.sa_handler = onSignal;
    action.sa_flags = SA_RESTART;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction before {};
        sigaction(signal, nullptr, &before);
        // Else by nohup, or as a shell's job in the background.
        if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
    }
}

bool interruptRequested() {
    return interrupted.load(std::memory_order_relaxed);
}

}  // namespace phat
