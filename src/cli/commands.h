#pragma once
// The subcommands of phat, one file each.

namespace CLI {
class App;
}

namespace phat {

// Each adds its subcommand to `app`. The work runs inside app.parse() and reports failure by an exception,
// which main turns into one line and an exit code.
void addBakeCommand(CLI::App& app);
void addRenderCommand(CLI::App& app);
void addCompareCommand(CLI::App& app);
void addInfoCommand(CLI::App& app);
void addExportCommand(CLI::App& app);
void addViewCommand(CLI::App& app);
void addWebCommand(CLI::App& app);
void addBenchCommand(CLI::App& app);

}  // namespace phat
