#pragma once
// What is drawn first: opaque surfaces, then those that others are seen through.

#include <vector>

#include "gl/scene_upload.h"

namespace phat {

/// Blended surfaces and glass.
bool isSeenThrough(const DrawnMaterials& materials, const DrawRange& draw);

/// Indices of the surfaces that are seen through, the farthest first, by their middles.
std::vector<uint32_t> farToNear(const std::vector<DrawRange>& ranges, const DrawnMaterials& materials,
                                const Camera& camera);

}  // namespace phat
