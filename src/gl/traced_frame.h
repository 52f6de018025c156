#pragma once
// Frames of the renderer whose sharp lobes are traced on the CPU.

#include "core/base/progress.h"
#include "gl/picture_sum.h"
#include "gl/renderer.h"

namespace phat {

/// Rays that replace the lookup for sharp lobes. Their input is the caller's, as are its
/// materials.
struct TracedReflections {
    const ReflectionScene& scene;
    Reflections reflections = Reflections::automatic;
    Progress& progress;  // drawFrame() throws Interrupted when it requests that
};

/// Whether still pictures are traced by the GPU unless somebody asks for the CPU: where OpenGL is not drawn
/// in software. pre: a context is current.
bool prefersGpuRays();

/// Cost of a frame's rays.
struct ReflectionCost {
    double seconds = 0;
    uint64_t rays = 0;
};

/// Renderer::draw with rays; `traced` null: all reflections are looked up. After Interrupted `sum` holds the
/// samples that were finished.
ReflectionCost drawFrame(Renderer& renderer, const FrameSettings& settings, const TracedReflections* traced,
                         PictureSum& sum);

}  // namespace phat
