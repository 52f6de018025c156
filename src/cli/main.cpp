// phat: bake, draw and measure PHATextures.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <new>

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
    try {
        app.parse(argc, argv);
        phat::finishOutput();
        return kDone;
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kDone : kWrongUsage;  // 0: --help and --version
    }
}

}  // namespace

int main(int argc, char** argv) {
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
