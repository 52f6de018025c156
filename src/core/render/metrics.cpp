#include "core/render/metrics.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace phat {
namespace {

double ratio(double numerator, double denominator) {
    if (numerator == 0) return 0;
    if (denominator == 0) return std::copysign(std::numeric_limits<double>::infinity(), numerator);
    return numerator / denominator;
}

}  // namespace

Metrics compareImages(const Image& test, const Image& reference, const Image* mask) {
    assert(test.width == reference.width && test.height == reference.height);
    assert(!mask || (mask->width == test.width && mask->height == test.height));
    const auto kept = [&](size_t i) { return !mask || mask->pixels[i].x > 0.5f; };

    Metrics metrics;
    double referenceSum = 0;
    for (size_t i = 0; i < reference.pixels.size(); ++i) {
        if (!kept(i)) continue;
        ++metrics.pixels;
        for (int c = 0; c < 3; ++c) referenceSum += reference.pixels[i][c];
    }
    if (metrics.pixels == 0) return metrics;
    const double values = 3.0 * double(metrics.pixels);
    const double mean = referenceSum / values;

    // Keeps black pixels of the reference from deciding the whole figure.
    const double floor = 0.01 * mean * mean;
    const std::vector<float> flip = flipMap(test, reference);
    double relative = 0, absolute = 0, difference = 0, flipSum = 0;
    for (size_t i = 0; i < reference.pixels.size(); ++i) {
        if (!kept(i)) continue;
        flipSum += flip[i];
        for (int c = 0; c < 3; ++c) {
            const double b = reference.pixels[i][c];
            const double d = test.pixels[i][c] - b;
            relative += ratio(d * d, b * b + floor);
            absolute += std::abs(d);
            difference += d;
        }
    }
    metrics.relMse = relative / values;
    metrics.maeOverMean = ratio(absolute / values, mean);
    metrics.bias = ratio(difference / values, mean);
    metrics.flip = flipSum / double(metrics.pixels);
    return metrics;
}

double noiseOverMean(const Image& reference, const Image& variance, const Image* mask) {
    double noise = 0, sum = 0;
    for (size_t i = 0; i < reference.pixels.size(); ++i) {
        if (mask && !(mask->pixels[i].x > 0.5f)) continue;
        for (int c = 0; c < 3; ++c) {
            noise += std::sqrt(2 / double(kPi) * std::max(double(variance.pixels[i][c]), 0.0));
            sum += reference.pixels[i][c];
        }
    }
    return ratio(noise, sum);
}

uint64_t countNonFinite(const Image& image) {
    uint64_t count = 0;
    for (const glm::vec3& pixel : image.pixels)
        count += !(std::isfinite(pixel.x) && std::isfinite(pixel.y) && std::isfinite(pixel.z));
    return count;
}

}  // namespace phat
