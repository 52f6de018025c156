#pragma once
// High dynamic range in 8-bit RGBA: a colour and what it is multiplied by. Lightmaps of game engines have it;
// this is the variant of PlayCanvas, whose range is 8: the square keeps the steps of dark colours small.

#include <algorithm>
#include <cmath>

#include "core/base/math.h"

namespace phat {

/// The range of values up to `largest`.
inline float rgbmRange(float largest) {
    return largest > 0 ? std::sqrt(largest) : 1.0f;
}

/// value = (range * a * rgb)^2, all of them in [0, 1]. The largest channel is off by at most 1/250 of itself
/// for a above 1/2, others by more. pre: 0 <= value, whose root is at most `range`.
inline glm::u8vec4 encodeRgbm(glm::vec3 value, float range) {
    const glm::vec3 root = glm::sqrt(value) / range;
    const float scale = std::clamp(std::ceil(255 * maxComponent(root)), 1.0f, 255.0f);
    const glm::vec3 rgb = glm::min(root * (255 / scale), glm::vec3(1));
    return glm::u8vec4(glm::round(255.0f * rgb), scale);
}

inline glm::vec3 decodeRgbm(glm::u8vec4 code, float range) {
    const glm::vec3 root = range * (float(code.a) / 255) * (glm::vec3(code) / 255.0f);
    return root * root;
}

}  // namespace phat
