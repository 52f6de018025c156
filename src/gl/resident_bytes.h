#pragma once
// What the renderer keeps in the GPU's memory.

#include "gl/display_pass.h"

namespace phat {

/// Without the passes' own pyramids.
ResidentBytes residentBytesOf(const GpuScene& scene, const GpuAtlas& atlas, const GpuLookup& lookup,
                              const ShadowMaps& shadows, const FrameTargets& targets);
uint64_t pyramidBytes(const RelightPass& pass);

}  // namespace phat
