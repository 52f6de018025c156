#pragma once
// The flags of `phat render`.

#include "cli/render_options.h"

namespace CLI {
class App;
}

namespace phat {

/// Declares the flags. Parsing writes into `options`, which must live as long as `command`.
void declareRenderOptions(CLI::App& command, RenderOptions& options);

/// Sets the options that depend on several flags, after parsing. Throws CLI::ValidationError where they
/// contradict each other or mean nothing to the method.
void finishRenderOptions(const CLI::App& command, RenderOptions& options);

}  // namespace phat
