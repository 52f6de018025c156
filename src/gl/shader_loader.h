#pragma once
// shaders/ to GL programs. The files carry no #version, no precision and no bindings, so that the browser
// reads the same ones; this loader adds what desktop GL wants and resolves #include "lib/x.glsl".

#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "gl/gl_objects.h"

namespace phat {

enum class GlslFlavor { desktop, web };  // #version 450 core, #version 300 es

/// A shader with its includes, each once and in order; `files` are the numbers of #line.
struct ShaderSource {
    std::string text;
    std::vector<std::string> files;
};

/// Reads `folder`/`name` and everything it includes (paths are relative to `folder`), after a preamble of
/// the flavour and one #define a name in `defines`. Throws GlError when a file is missing.
ShaderSource assembleShader(const std::string& folder, const std::string& name, GlslFlavor flavor,
                            const std::vector<std::string>& defines = {});

/// Compiles one stage. Throws GlError with the first line of the driver's log, file names restored.
GlShader compileShader(GLenum stage, const ShaderSource& source);

/// Whether the driver compiles programs in the background, and says when they are ready.
bool compilesInBackground();

/// A program. Uniforms that the compiler removed are silently ignored.
class ShaderProgram {
  public:
    ShaderProgram();
    ~ShaderProgram();
    ShaderProgram(ShaderProgram&&) noexcept;
    ShaderProgram& operator=(ShaderProgram&&) noexcept;
    /// Asks the driver to compile it; whatever uses it first waits until that is done, and throws GlError if
    /// the shaders are wrong. Throws GlError when a file is missing.
    ShaderProgram(const std::string& folder, const std::string& vertexFile, const std::string& fragmentFile,
                  const std::vector<std::string>& defines = {}, GlslFlavor flavor = GlslFlavor::desktop);

    /// Whether using it would not wait; true where the driver does not say.
    bool isReady() const;
    void use() const;
    /// 0: none was made.
    GLuint name() const { return program_.name(); }

    void set(const char* uniform, int value) const;
    void set(const char* uniform, float value) const;
    void set(const char* uniform, glm::vec2 value) const;
    void set(const char* uniform, glm::ivec2 value) const;
    void set(const char* uniform, glm::vec3 value) const;
    void set(const char* uniform, const glm::mat4& value) const;
    void set(const char* uniform, std::span<const glm::vec4> values) const;
    void set(const char* uniform, std::span<const glm::uvec4> values) const;
    /// Binds `texture` (and `sampler`, if not 0) to `unit` and points the uniform at it.
    void bind(const char* uniform, int unit, GLuint texture, GLuint sampler = 0) const;

  private:
    struct Stages;
    /// Waits for the driver, the first time. What it keeps is no part of what the program is.
    void finish() const;
    GLint location(const char* uniform) const;

    GlProgram program_;
    mutable std::unique_ptr<Stages> stages_;  // until it is finished
    mutable std::unordered_map<std::string, GLint> locations_;
};

}  // namespace phat
