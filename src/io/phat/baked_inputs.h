#pragma once
// What a baked file says of the inputs of its stages, so that a later bake takes over what has not changed.

#include <nlohmann/json_fwd.hpp>

#include "core/bake/stage_keys.h"

namespace phat {

/// Everything 0: not known.
struct BakedInputs {
    double wallTexelSizeMeters = 0;  // LoadedScene's
    StageKeys keys;
    uint64_t probes = 0;  // key of the light probes
};

nlohmann::json describeInputs(const BakedInputs& inputs);
/// `object`: null where there is none. What is malformed is not known.
BakedInputs readInputs(const nlohmann::json& object);

}  // namespace phat
