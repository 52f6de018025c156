#pragma once
// Memory of the renderer's GPU resources.

#include "gl/added_pass.h"
#include "gl/display_pass.h"

namespace phat {

/// Without the textures of the pyramids alone, but with the guides' densities.
ResidentBytes residentBytesOf(const GpuScene& scene, const GpuAtlas& atlas, const GpuLookup& lookup,
                              const ShadowMaps& shadows, const FrameTargets& targets);
uint64_t addedBytes(const GpuAdded& added);
uint64_t rayBytes(const GpuRayScene& rays);
uint64_t pyramidBytes(const RelightPass& pass);
uint64_t surfaceBytes(const GpuTexelSurfaces& surfaces);

}  // namespace phat
