#pragma once
// A picture that samples are added to.

#include <glm/glm.hpp>

#include "core/base/image.h"
#include "gl/gl_objects.h"

namespace phat {

/// Sums of `samples` pictures, each shifted inside the pixel; the mean is box-filtered over the pixel.
struct PictureSum {
    glm::uvec2 size{0};
    int samples = 0;
    bool preview = false;  // one sample by the preview's program: the next begins anew
    GlTexture texture;     // RGBA32F, row 0 at the bottom
    GlFramebuffer target;
};

PictureSum createPictureSum(glm::uvec2 size);

/// The mean, row 0 on top. Waits for the GPU.
Image readMean(const PictureSum& sum);

}  // namespace phat
