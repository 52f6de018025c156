#pragma once
// How far one picture is from another.

#include <cstdint>
#include <vector>

#include "core/base/image.h"

namespace phat {

struct Metrics {
    double relMse = 0;       // mean over pixels and channels of (a - b)^2 / (b^2 + .01 mean(b)^2)
    double maeOverMean = 0;  // mean |a - b| / mean b
    double bias = 0;         // mean (a - b) / mean b
    double flip = 0;         // mean of flipMap
    uint64_t pixels = 0;     // that the mask kept
};

/// `mask`: keep pixels whose first channel exceeds .5; null: all. Means are over the kept pixels and their
/// channels; what would divide by the mean of a black reference is 0 for equal pictures, else infinite.
/// All but FLIP do not change when both pictures are scaled. pre: equal sizes; finite pixels.
Metrics compareImages(const Image& test, const Image& reference, const Image* mask = nullptr);

/// MAE/mean that noise of this variance alone would bring, were it normal: the mean of sqrt(2 v / pi) over
/// the reference's. What a reference cannot tell apart. pre: as compareImages.
double noiseOverMean(const Image& reference, const Image& variance, const Image* mask = nullptr);

/// Pixels with a channel that is infinite or not a number.
uint64_t countNonFinite(const Image& image);

/// LDR-FLIP error map in [0,1], [y][x]; source: Andersson et al. 2020, "FLIP: A Difference Evaluator for
/// Alternating Images". Inputs: linear, clamped to [0,1]; the caller applies the exposure.
/// pixelsPerDegree 67: 0.7 m from a 0.7 m wide 4K screen. pre: equal sizes; finite pixels;
/// pixelsPerDegree >= 8, below which the filters are narrower than a pixel.
std::vector<float> flipMap(const Image& test, const Image& reference, float pixelsPerDegree = 67.0f);

}  // namespace phat
