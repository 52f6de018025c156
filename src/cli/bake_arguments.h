#pragma once
// The flags of `phat bake`.

#include <optional>
#include <string>

#include "core/bake/bake_settings.h"
#include "core/probes/bake_probes.h"
#include "io/phat/baked_file.h"
#include "io/phat/scene_lighting.h"

namespace CLI {
class App;
}

namespace phat {

inline constexpr uint64_t kMinTexels = 64;

struct BakeOptions {
    std::string input;
    std::string output;
    bool outputGiven = false;
    SceneLighting lighting;
    std::string variant;        // of the materials; empty: none
    std::string earlier;        // baked file whose charts are kept; empty: none
    bool takesResults = false;  // of it, too
    BakeSettings settings;
    ProbeSettings probes;
    PhatexelStorage storage = PhatexelStorage::packed;
    std::optional<int> threads;
    double memoryLimitBytes = 0;
    std::optional<uint64_t> maxBytes;  // of the file
    bool resume = false;
    bool quiet = false;
    bool json = false;
};

/// Declares the flags. Parsing writes into `options`, which must live as long as `command`.
void declareBakeOptions(CLI::App& command, BakeOptions& options);

/// Sets the options that depend on several flags, after parsing. Throws CLI::ValidationError where they
/// contradict each other.
void finishBakeOptions(const CLI::App& command, BakeOptions& options);

}  // namespace phat
