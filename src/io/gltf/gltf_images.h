#pragma once
// The pictures of a glTF file.

#include "core/scene/scene.h"
#include "io/gltf/gltf_document.h"

namespace phat::gltf {

/// Decodes the images that materials use into scene.images and points the slots at them. An image that cannot
/// be had is noted once and its slots become empty (white). Throws Problem when the pictures need more memory
/// than the budget has.
void loadImages(const Document& document, Scene& scene, MemoryBudget& budget, Notes& notes);

}  // namespace phat::gltf
