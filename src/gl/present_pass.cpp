#include "gl/present_pass.h"

#include <algorithm>

#include "gl/textures.h"

namespace phat {

PresentPass createPresentPass(const std::string& folder) {
    PresentPass pass;
    pass.present = FullscreenProgram(folder, "present.frag");
    pass.linear = createSampler(GL_CLAMP_TO_EDGE, GL_CLAMP_TO_EDGE, GL_LINEAR, GL_LINEAR);
    return pass;
}

void present(const PresentPass& pass, const Presented& left, const Presented& right, GLuint target,
             glm::ivec4 viewport, const PresentSettings& settings) {
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    glViewport(viewport.x, viewport.y, viewport.z, viewport.w);
    glDisable(GL_BLEND);
    const ShaderProgram& program = pass.present.program;
    program.bind("left", 0, left.texture, pass.linear.name());
    program.bind("right", 1, right.texture, pass.linear.name());
    program.set("leftScale", 1.0f / float(std::max(left.samples, 1)));
    program.set("rightScale", 1.0f / float(std::max(right.samples, 1)));
    program.set("corner", glm::vec2(viewport.x, viewport.y));
    program.set("size", glm::vec2(viewport.z, viewport.w));
    program.set("wipe", settings.wipe * float(viewport.z));
    program.set("leftHeat", left.heatPerUnit);
    program.set("rightHeat", right.heatPerUnit);
    const auto setToneMap = [&](const char* toneMapping, const char* exposureStops, bool light) {
        program.set(toneMapping, int(light ? settings.toneMap : ToneMap::linear));
        program.set(exposureStops, light ? settings.exposureStops : 0.0f);
    };
    setToneMap("leftToneMapping", "leftExposureStops", left.light);
    setToneMap("rightToneMapping", "rightExposureStops", right.light);
    program.set("difference", int(settings.difference));
    pass.present.draw();
    glBindSampler(0, 0);
    glBindSampler(1, 0);
}

}  // namespace phat
