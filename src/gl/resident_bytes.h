#pragma once
// What the renderer keeps in the GPU's memory.

#include "gl/display_pass.h"

namespace phat {

/// Without what is made for the pyramids alone, but for the guides' densities.
ResidentBytes residentBytesOf(const GpuScene& scene, const GpuAtlas& atlas, const GpuLookup& lookup,
                              const ShadowMaps& shadows, const FrameTargets& targets);
uint64_t pyramidBytes(const RelightPass& pass);
uint64_t surfaceBytes(const GpuTexelSurfaces& surfaces);

}  // namespace phat
