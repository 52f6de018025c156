#include "gl/picture_sum.h"

#include <algorithm>

#include "gl/textures.h"

namespace phat {

PictureSum createPictureSum(glm::uvec2 size) {
    PictureSum sum;
    sum.size = size;
    sum.texture = createTexture2D(GL_RGBA32F, size);
    sum.target = createFramebuffer({{sum.texture.name()}});
    return sum;
}

Image readMean(const PictureSum& sum) {
    Image image(int(sum.size.x), int(sum.size.y));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, sum.target.name());
    glReadBuffer(GL_COLOR_ATTACHMENT0);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, image.width, image.height, GL_RGB, GL_FLOAT, image.pixels.data());
    const float scale = 1.0f / float(std::max(sum.samples, 1));
    for (glm::vec3& pixel : image.pixels) pixel *= scale;
    // OpenGL's row 0 is the bottom.
    for (int y = 0; y < image.height / 2; ++y)
        std::swap_ranges(&image.at(0, y), &image.at(0, y) + image.width, &image.at(0, image.height - 1 - y));
    return image;
}

}  // namespace phat
