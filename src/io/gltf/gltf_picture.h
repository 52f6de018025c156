#pragma once
// Encoded pictures in memory, by what their bytes say they are.

#include <cstdint>
#include <span>
#include <string_view>

#include "core/scene/scene.h"
#include "io/gltf/gltf_problem.h"

namespace phat::gltf {

/// Stops the load where another Problem costs a picture only.
struct BudgetProblem : Problem {
    using Problem::Problem;
};

/// The MIME type of a PNG, JPEG, WebP, AVIF or KTX2 picture; empty: none of these.
std::string_view pictureType(std::span<const uint8_t> bytes);

/// Decodes a PNG, JPEG, WebP or AVIF picture; the size that it announces is charged before memory is taken.
/// Throws Problem, whose message goes on from the picture's name.
TextureImage decodePicture(std::span<const uint8_t> bytes, MemoryBudget& budget);

}  // namespace phat::gltf
