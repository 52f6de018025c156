// phat: bake, draw and measure PHATextures.

#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <string_view>

#include "cli/available_threads.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "core/base/progress.h"
#include "io/base/file_error.h"
#include "io/base/printable.h"

namespace {

enum ExitCode { kDone = 0, kFailed = 1, kWrongUsage = 2, kInterrupted = 130 };

int fail(const char* reason) {
    phat::tell(fmt::format("phat: {}\n", phat::printable(reason)));
    return kFailed;
}

int run(int argc, char** argv) {
    CLI::App app("Interactive glossy global illumination from a bake.", "phat");
    app.set_version_flag("--version", "phat " PHAT_VERSION);
    app.require_subcommand(1);
    app.footer("phat COMMAND --help explains a command.");
    app.failure_message([](const CLI::App*, const CLI::Error& error) {
        return fmt::format("phat: {}\n", error.what());  // one line, as all errors
    });
    phat::addBakeCommand(app);
    phat::addRenderCommand(app);
    phat::addCompareCommand(app);
    phat::addInfoCommand(app);
    phat::addExportCommand(app);
    phat::addViewCommand(app);
    phat::addWebCommand(app);
    phat::addBenchCommand(app);
    std::optional<tbb::global_control> threads;
    app.parse_complete_callback([&] { threads = phat::useAvailableThreads(); });  // --help needs none
    try {
        app.parse(argc, argv);
        phat::finishOutput();
        return kDone;
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kDone : kWrongUsage;  // 0: --help and --version
    }
}

// Libraries allocate in functions that must not throw, such as the destructors of JSON. All that is left to
// do then is to say what has happened.
[[noreturn]] void onTerminate() {
    try {
        if (std::current_exception()) std::rethrow_exception(std::current_exception());
    } catch (const std::bad_alloc&) {
        constexpr std::string_view kText = "phat: out of memory\n";
        std::fwrite(kText.data(), 1, kText.size(), stderr);  // unbuffered
        _exit(kFailed);
    } catch (...) {
    }
    std::abort();
}

// Large arrays go back to the system when they are freed, whatever else is held: by default the C library
// keeps some for later as soon as one has been freed, and how much memory a bake takes could not be said
// before.
void returnFreedMemory() {
    constexpr int kLargeBytes = 256 << 10;
    mallopt(M_MMAP_THRESHOLD, kLargeBytes);
}

}  // namespace

int main(int argc, char** argv) {
    std::set_terminate(onTerminate);
    returnFreedMemory();
    phat::secureStandardStreams();
    try {
        return run(argc, argv);
    } catch (const phat::Interrupted& error) {
        fail(error.what());
        return kInterrupted;
    } catch (const std::bad_alloc&) {
        return fail("out of memory");
    } catch (const std::exception& error) {  // FileError and GlError say what and why
        return fail(error.what());
    }
}
