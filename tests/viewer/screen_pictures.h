#pragma once
// Comparing what a screen shows.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/image.h"
#include "core/base/math.h"

namespace phat {

inline double meanDifference(const Image& a, const Image& b) {
    double sum = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i)
        sum += double(maxComponent(glm::abs(a.pixels[i] - b.pixels[i])));
    return sum / double(a.pixels.size());
}

inline float largestDifference(const Image& a, const Image& b) {
    EXPECT_EQ(a.pixels.size(), b.pixels.size());
    float largest = 0;
    for (size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i)
        largest = std::max(largest, maxComponent(glm::abs(a.pixels[i] - b.pixels[i])));
    return largest;
}

inline Image cut(const Image& image, glm::ivec2 corner, glm::ivec2 size) {
    Image out(size.x, size.y);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) out.at(x, y) = image.at(corner.x + x, corner.y + y);
    return out;
}

/// Display values as the window shows them.
inline Image srgb(Image linear) {
    for (glm::vec3& pixel : linear.pixels)
        for (int c = 0; c < 3; ++c)
            pixel[c] =
                pixel[c] <= 0.0031308f ? 12.92f * pixel[c] : 1.055f * std::pow(pixel[c], 1 / 2.4f) - 0.055f;
    return linear;
}

}  // namespace phat
