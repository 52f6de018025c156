#pragma once
// A float image: the representation of every image between the stages.

#include <vector>

#include "core/base/math.h"

namespace phat {

/// Linear Rec. 709 unless a name says otherwise. Layout [y][x], row 0 is the top.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<glm::vec3> pixels;

    Image() = default;
    Image(int w, int h, glm::vec3 fill = glm::vec3(0)) : width(w), height(h), pixels(size_t(w) * h, fill) {}

    glm::vec3& at(int x, int y) { return pixels[size_t(y) * width + x]; }
    const glm::vec3& at(int x, int y) const { return pixels[size_t(y) * width + x]; }
};

}  // namespace phat
