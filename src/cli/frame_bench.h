#pragma once
// Times of the passes of a frame while the view moves, for `phat bench`.

#include <nlohmann/json.hpp>

#include "core/base/progress.h"
#include "gl/renderer.h"

namespace phat {

struct BenchSettings {
    int frames = 32;
    float unitMeters = 1;  // lengthUnit() of the scene: how far the eye moves
};

/// Draws frames of one sample each, in which the eye sways and the view swings about its vertical, after some
/// that warm up. Medians in milliseconds: "passMilliseconds" of each pass that ran, "gpuMilliseconds" of all
/// of them, "frameMilliseconds" by the clock, until the GPU was done; where rays are traced "raysPerPixel",
/// "fetchesPerPixel" of texels that tracing reads, and "raysPerSecond" of the passes that they need; and
/// "reads", the lookup's reads of texels a pixel by source of light, where something is looked up.
nlohmann::ordered_json benchFrames(Renderer& renderer, FrameSettings frame, const BenchSettings& settings,
                                   Progress& progress);

}  // namespace phat
