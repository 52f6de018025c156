#pragma once
// A GLB taken apart for a mutation, and put together again with lengths that are right.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/base/random.h"

namespace phat::fuzz {

struct GlbParts {
    nlohmann::json json;  // an object
    std::vector<uint8_t> binary;
};

/// Nothing where the bytes are no GLB with JSON that can be parsed.
std::optional<GlbParts> partsOfGlb(std::span<const uint8_t> bytes);

/// The GLB, written over `data` if it fits into `maxSize`; its size, or 0.
size_t writeGlb(const GlbParts& parts, uint8_t* data, size_t maxSize);

/// Changes up to three values of `root`, or moves, repeats and removes them; what it puts there is what glTF
/// knows, and numbers at the edges of types.
void mutateJson(nlohmann::json& root, Rng& rng);

/// A number below `count`. pre: count > 0.
inline size_t below(Rng& rng, size_t count) {
    return size_t(rng.bits64() % count);
}
inline bool oneIn(Rng& rng, size_t count) {
    return below(rng, count) == 0;
}

}  // namespace phat::fuzz
