#include "gl/textures.h"

#include <fmt/format.h>

#include <algorithm>

#include "gl/gl_error.h"

namespace phat {
namespace {

void requireSize(glm::uvec2 size, int layers) {
    GLint maxSide = 0, maxLayers = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &maxSide);
    glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &maxLayers);
    if (std::max(size.x, size.y) > uint32_t(maxSide) || layers > maxLayers) {
        throw GlError(fmt::format("a texture of {} x {} x {} exceeds this machine's limit of {} x {} x {}",
                                  size.x, size.y, layers, maxSide, maxSide, maxLayers));
    }
}

void setNearest(GLuint texture, int levels) {
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, levels > 1 ? GL_NEAREST_MIPMAP_NEAREST : GL_NEAREST);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

template <typename Texel>
GlTexture tableOf(GLenum stored, GLenum format, GLenum type, std::span<const Texel> values) {
    const uint32_t rows = std::max(1u, (uint32_t(values.size()) + kTableWidth - 1) / kTableWidth);
    GlTexture table = createTexture2D(stored, {kTableWidth, rows});
    for (uint32_t row = 0; size_t(row) * kTableWidth < values.size(); ++row) {
        const size_t first = size_t(row) * kTableWidth;
        const size_t count = std::min<size_t>(kTableWidth, values.size() - first);
        glTextureSubImage2D(table.name(), 0, 0, GLint(row), GLsizei(count), 1, format, type, &values[first]);
    }
    return table;
}

}  // namespace

GlTexture createTexture2D(GLenum format, glm::uvec2 size, int levels) {
    requireSize(size, 1);
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    GlTexture texture(name);
    glTextureStorage2D(name, levels, format, GLsizei(size.x), GLsizei(size.y));
    setNearest(name, levels);
    return texture;
}

GlTexture createTextureArray(GLenum format, glm::uvec2 size, int layers, int levels) {
    requireSize(size, layers);
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
    GlTexture texture(name);
    glTextureStorage3D(name, levels, format, GLsizei(size.x), GLsizei(size.y), layers);
    setNearest(name, levels);
    return texture;
}

uint64_t textureBytes(const GlTexture& texture) {
    if (!texture) return 0;
    GLint levels = 0;
    glGetTextureParameteriv(texture.name(), GL_TEXTURE_IMMUTABLE_LEVELS, &levels);
    uint64_t bytes = 0;
    for (GLint level = 0; level < levels; ++level) {
        const auto ask = [&](GLenum what) {
            GLint value = 0;
            glGetTextureLevelParameteriv(texture.name(), level, what, &value);
            return uint64_t(value);
        };
        uint64_t bits = ask(GL_TEXTURE_SHARED_SIZE);
        for (const GLenum channel : {GL_TEXTURE_RED_SIZE, GL_TEXTURE_GREEN_SIZE, GL_TEXTURE_BLUE_SIZE,
                                     GL_TEXTURE_ALPHA_SIZE, GL_TEXTURE_DEPTH_SIZE})
            bits += ask(channel);
        bytes += ask(GL_TEXTURE_WIDTH) * ask(GL_TEXTURE_HEIGHT) * ask(GL_TEXTURE_DEPTH) * bits / 8;
    }
    return bytes;
}

GlSampler createSampler(GLenum wrapU, GLenum wrapV, GLenum minFilter, GLenum magFilter) {
    GLuint name = 0;
    glCreateSamplers(1, &name);
    glSamplerParameteri(name, GL_TEXTURE_WRAP_S, GLint(wrapU));
    glSamplerParameteri(name, GL_TEXTURE_WRAP_T, GLint(wrapV));
    glSamplerParameteri(name, GL_TEXTURE_MIN_FILTER, GLint(minFilter));
    glSamplerParameteri(name, GL_TEXTURE_MAG_FILTER, GLint(magFilter));
    return GlSampler(name);
}

GlFramebuffer createFramebuffer(const std::vector<Attachment>& colors, GLuint depth) {
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    GlFramebuffer framebuffer(name);
    std::vector<GLenum> buffers;
    for (const Attachment& color : colors) {
        const GLenum slot = GL_COLOR_ATTACHMENT0 + GLenum(buffers.size());
        if (color.layer < 0)
            glNamedFramebufferTexture(name, slot, color.texture, color.level);
        else
            glNamedFramebufferTextureLayer(name, slot, color.texture, color.level, color.layer);
        buffers.push_back(slot);
    }
    if (depth != 0) glNamedFramebufferTexture(name, GL_DEPTH_ATTACHMENT, depth, 0);
    glNamedFramebufferDrawBuffers(name, GLsizei(buffers.size()), buffers.data());
    checkGl("creating a framebuffer");  // an attachment that found no memory says so
    if (glCheckNamedFramebufferStatus(name, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw GlError("the graphics driver cannot draw to float textures");
    return framebuffer;
}

GlTexture createTable(std::span<const glm::vec4> values) {
    return tableOf(GL_RGBA32F, GL_RGBA, GL_FLOAT, values);
}

GlTexture createTable(std::span<const glm::uvec4> values) {
    return tableOf(GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, values);
}

void checkGl(const char* doing) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) return;
    // Later errors must not be attributed to the next call. A lost context never ends to report.
    for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR; ++i) {
    }
    if (error == GL_OUT_OF_MEMORY) throw GlError(fmt::format("out of video memory while {}", doing));
    throw GlError(fmt::format("OpenGL error 0x{:04x} while {}", error, doing));
}

}  // namespace phat
