#pragma once
// How far one picture is from another.

#include <span>

#include "core/image.h"

namespace phat {

struct Metrics {
    double relMse = 0;       // mean over pixels and channels of (a - b)^2 / (b^2 + .01 mean(b)^2)
    double maeOverMean = 0;  // mean |a - b| / mean b
    double bias = 0;         // mean (a - b) / mean b
    double flip = 0;         // mean LDR-FLIP of the tone-mapped pictures
    uint64_t pixels = 0;     // that the mask kept
};

/// `mask`: keep pixels whose first channel exceeds .5; null: all. pre: equal sizes.
Metrics compareImages(const Image& test, const Image& reference, const Image* mask = nullptr);

/// LDR-FLIP error map in [0,1], source: Andersson et al. 2020. Inputs: linear, clamped to [0,1] after
/// `exposure` stops and sRGB-encoded. pixelsPerDegree 67: 0.7 m from a 0.7 m wide 4K screen.
std::vector<float> flipMap(const Image& test, const Image& reference, float pixelsPerDegree = 67.0f);

}  // namespace phat
