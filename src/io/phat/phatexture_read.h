#pragma once
// The PHATexels and what lies beside them in a baked file.

#include "io/phat/baked_file.h"
#include "io/phat/payload_reader.h"

namespace phat {

/// `extension`: the whole of it. Throws std::runtime_error and json exceptions where it is not as
/// docs/format.md has it.
Phatexture readPhatexture(PayloadReader& reader, const nlohmann::json& extension, PhatexelStorage storage,
                          const Atlas& atlas);

}  // namespace phat
