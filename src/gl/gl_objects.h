#pragma once
// Owners of OpenGL names: freed in the destructor, moved, never copied. A current context must outlive them.

#include <epoxy/gl.h>

#include <utility>

namespace phat {

template <void (*kDelete)(GLuint)>
class GlName {
  public:
    GlName() = default;
    explicit GlName(GLuint name) : name_(name) {}
    ~GlName() { reset(); }
    GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    GlName& operator=(GlName&& other) noexcept {
        if (this != &other) {
            reset();
            name_ = std::exchange(other.name_, 0);
        }
        return *this;
    }

    GLuint name() const { return name_; }
    explicit operator bool() const { return name_ != 0; }
    void reset() {
        if (name_ != 0) kDelete(name_);
        name_ = 0;
    }

  private:
    GLuint name_ = 0;
};

namespace gl_delete {
inline void texture(GLuint name) {
    glDeleteTextures(1, &name);
}
inline void sampler(GLuint name) {
    glDeleteSamplers(1, &name);
}
inline void buffer(GLuint name) {
    glDeleteBuffers(1, &name);
}
inline void vertexArray(GLuint name) {
    glDeleteVertexArrays(1, &name);
}
inline void framebuffer(GLuint name) {
    glDeleteFramebuffers(1, &name);
}
inline void query(GLuint name) {
    glDeleteQueries(1, &name);
}
inline void shader(GLuint name) {
    glDeleteShader(name);
}
inline void program(GLuint name) {
    glDeleteProgram(name);
}
}  // namespace gl_delete

using GlTexture = GlName<gl_delete::texture>;
using GlSampler = GlName<gl_delete::sampler>;
using GlBuffer = GlName<gl_delete::buffer>;
using GlVertexArray = GlName<gl_delete::vertexArray>;
using GlFramebuffer = GlName<gl_delete::framebuffer>;
using GlQuery = GlName<gl_delete::query>;
using GlShader = GlName<gl_delete::shader>;
using GlProgram = GlName<gl_delete::program>;

}  // namespace phat
