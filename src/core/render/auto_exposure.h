#pragma once
// Exposure from a picture itself.

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/image.h"
#include "core/scene/rays.h"

namespace phat {

/// Stops for display: a scene's own brightness, seldom a display's, is brought to middle grey. The mean
/// logarithm of the luminance of `pixels` (y * width + x; where they hold no light, of all), without the
/// darkest and the brightest of them, becomes kMiddleGrey, unless that would wash out more than the brightest
/// pixels. A multiple of .1, so that the number says exactly what was applied, within +-kMaxStops; 0 for a
/// black picture. source: the log-average of Reinhard et al. 2002, "Photographic Tone Reproduction for
/// Digital Images".
float autoExposureStops(const Image& picture, std::span<const uint32_t> pixels);

/// The pixels of such a picture that show surfaces in light: neither the sky nor what shines itself. Of large
/// pictures a part.
std::vector<uint32_t> meteredPixels(const RayScene& rays, const Camera& camera, int width, int height);

inline constexpr float kMiddleGrey = 0.22f;
inline constexpr float kMaxStops = 30;

}  // namespace phat
