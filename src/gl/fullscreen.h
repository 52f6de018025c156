#pragma once
// A fragment shader run once for every pixel of a target.

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "gl/gl_objects.h"
#include "gl/shader_loader.h"

namespace phat {

/// fullscreen.vert, whose one triangle needs no vertices, with a fragment shader.
struct FullscreenProgram {
    FullscreenProgram() = default;
    /// Throws GlError.
    FullscreenProgram(const std::string& shaderFolder, const std::string& fragmentFile,
                      const std::vector<std::string>& defines = {});

    /// Over all of the viewport that is set; depth and faces are not tested.
    void draw() const;
    /// Over a target of `size`.
    void draw(const GlFramebuffer& target, glm::uvec2 size) const;
    /// Likewise, and writes the depth that the shader says.
    void drawDepth(const GlFramebuffer& target, glm::uvec2 size) const;
    /// Likewise, but over those pixels alone whose depth exceeds `depth`: GPUs do not run the shader
    /// elsewhere.
    void drawBefore(const GlFramebuffer& target, glm::uvec2 size, float depth) const;

    ShaderProgram program;
    GlVertexArray noVertices;  // core profiles draw nothing without one

  private:
    void drawTriangle() const;
    void drawTested(const GlFramebuffer& target, glm::uvec2 size) const;
};

}  // namespace phat
