#pragma once
// The flags that light a scene: --sky, --environment and what belongs to it, --ies.

#include "cli/declare_option.h"
#include "io/phat/scene_lighting.h"

namespace phat {

/// Declares the flags. Parsing writes into `lighting`, which must live as long as the command.
void declareLighting(const DeclareOption& declare, SceneLighting& lighting);

/// Reads the value of --sky: auto, none, or KEY=VALUE,... of sun=AZIMUTH,ELEVATION (or time=, latitude=,
/// longitude=) and turbidity=. Throws CLI::ValidationError.
void parseSky(const std::string& text, SceneLighting& lighting);

/// Says on stderr what was added, a line each.
void printLines(const std::string& input, const std::vector<std::string>& lines);

}  // namespace phat
