#include "io/phat/paper_storage.h"

#include <cmath>
#include <glm/gtc/packing.hpp>
#include <stdexcept>

#include "core/phatexel/direction_cells.h"

namespace phat {
namespace {

constexpr uint32_t kInvalidAngles = ~0u;
// The paper's storage has no distances: those of packed PHATexels are lost, or infinite, in every unit.
constexpr float kNoUnit = 1;

void check(const PackedPhatexel16& texel) {
    if (texel.anglesHalf == kInvalidAngles) return;
    for (int c = 0; c < 3; ++c)
        if (!(texel.radiance[c] >= 0 && std::isfinite(texel.radiance[c])))
            throw std::runtime_error("a PHATexel's radiance is not a number");
    const glm::vec2 angles = glm::unpackHalf2x16(texel.anglesHalf);
    if (!(angles.x >= 0 && angles.x <= kPi / 2) || !(std::abs(angles.y) <= kPi))
        throw std::runtime_error("a PHATexel's direction does not lie in its hemisphere");
}

}  // namespace

std::vector<PackedPhatexel16> paperOfPacked(std::span<const PackedPhatexel> texels) {
    std::vector<PackedPhatexel16> paper;
    paper.reserve(texels.size());
    for (const PackedPhatexel texel : texels) paper.push_back(packPhatexel16(unpackPhatexel(texel, kNoUnit)));
    return paper;
}

std::vector<PackedPhatexel> packedOfPaper(std::span<const PackedPhatexel16> texels) {
    std::vector<PackedPhatexel> packed;
    packed.reserve(texels.size());
    for (const PackedPhatexel16& texel : texels) {
        check(texel);
        Phatexel phatexel = unpackPhatexel16(texel);
        if (phatexel.valid) phatexel.directionBlock = storableDirection(phatexel.directionBlock);
        packed.push_back(packPhatexel(phatexel, kNoUnit));
    }
    return packed;
}

}  // namespace phat
