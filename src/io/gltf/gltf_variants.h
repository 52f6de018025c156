#pragma once
// KHR_materials_variants: the looks that a file offers.

#include <string>
#include <vector>

#include "io/gltf/gltf_source.h"

namespace phat {

/// Their names, in the file's order. Those that are malformed are left out.
std::vector<std::string> gltfVariants(const GltfSource& source);

}  // namespace phat
