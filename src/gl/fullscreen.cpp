#include "gl/fullscreen.h"

namespace phat {
namespace {

void bindTarget(const GlFramebuffer& target, glm::uvec2 size) {
    glBindFramebuffer(GL_FRAMEBUFFER, target.name());
    glViewport(0, 0, GLsizei(size.x), GLsizei(size.y));
}

}  // namespace

FullscreenProgram::FullscreenProgram(const std::string& folder, const std::string& fragmentFile,
                                     const std::vector<std::string>& defines)
    : program(folder, "fullscreen.vert", fragmentFile, defines) {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    noVertices = GlVertexArray(name);
}

void FullscreenProgram::drawTriangle() const {
    glDisable(GL_CULL_FACE);
    glBindVertexArray(noVertices.name());
    program.use();
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

void FullscreenProgram::draw() const {
    glDisable(GL_DEPTH_TEST);
    drawTriangle();
}

void FullscreenProgram::draw(const GlFramebuffer& target, glm::uvec2 size) const {
    bindTarget(target, size);
    draw();
}

void FullscreenProgram::drawTested(const GlFramebuffer& target, glm::uvec2 size) const {
    bindTarget(target, size);
    glEnable(GL_DEPTH_TEST);
    drawTriangle();
}

void FullscreenProgram::drawDepth(const GlFramebuffer& target, glm::uvec2 size) const {
    glDepthFunc(GL_ALWAYS);
    glDepthMask(GL_TRUE);
    drawTested(target, size);
    glDepthMask(GL_FALSE);
}

void FullscreenProgram::drawBefore(const GlFramebuffer& target, glm::uvec2 size, float depth) const {
    glDepthFunc(GL_LESS);
    glDepthMask(GL_FALSE);
    glDepthRangef(depth, depth);
    drawTested(target, size);
    glDepthRangef(0, 1);
}

}  // namespace phat
