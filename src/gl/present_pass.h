#pragma once
// Pictures onto a window.

#include <string>

#include "gl/fullscreen.h"
#include "gl/gl_objects.h"
#include "gl/renderer.h"

namespace phat {

struct PresentPass {
    FullscreenProgram present;
    GlSampler linear;
};

PresentPass createPresentPass(const std::string& shaderFolder);

/// A texture whose texels are sums of `samples` radiances, row 0 at the bottom. Of any size: it is stretched.
struct Presented {
    GLuint texture = 0;
    int samples = 1;
    bool light = true;      // else display-linear values, shown as they are
    float heatPerUnit = 0;  // > 0: numbers, shown as heat between 0 and 1 over this
};

struct PresentSettings {
    ToneMap toneMap = ToneMap::agx;
    float exposureStops = 0;
    float wipe = 1;           // fraction of the width that shows the left picture
    bool difference = false;  // |left - right| / (right + .05) after tone mapping, as heat from 0 to 1
};

/// Draws over `viewport` (x, y from the bottom left, width, height) of `target` (0: the window),
/// sRGB-encoded.
void present(const PresentPass& pass, const Presented& left, const Presented& right, GLuint target,
             glm::ivec4 viewport, const PresentSettings& settings);

}  // namespace phat
