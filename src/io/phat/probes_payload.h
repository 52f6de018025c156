#pragma once
// Light probes in a baked file.

#include "core/probes/light_probes.h"
#include "io/phat/payload_reader.h"

namespace phat {

/// The extension's "probes" but for its payloads.
nlohmann::json describeProbes(const LightProbes& probes);

/// None where the file has none. `extension`: the whole of it. Throws std::runtime_error and json exceptions
/// where they are not as docs/format.md has it.
LightProbes readLightProbes(PayloadReader& reader, const nlohmann::json& extension);

}  // namespace phat
