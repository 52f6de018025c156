#pragma once
// Creation of textures and framebuffers with the machine's limits checked first.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "gl/gl_objects.h"

namespace phat {

/// Immutable storage, nearest filtering, clamped. Throws GlError when a side exceeds GL_MAX_TEXTURE_SIZE.
GlTexture createTexture2D(GLenum format, glm::uvec2 size, int levels = 1);
GlTexture createTextureArray(GLenum format, glm::uvec2 size, int layers, int levels = 1);

/// Of all levels and layers; 0 for an empty name.
uint64_t textureBytes(const GlTexture& texture);

GlSampler createSampler(GLenum wrapU, GLenum wrapV, GLenum minFilter, GLenum magFilter);

/// Layer or level of a texture as a colour attachment.
struct Attachment {
    GLuint texture = 0;
    int level = 0;
    int layer = -1;  // < 0: not an array
};
/// Throws GlError when the driver cannot draw to these formats together. `depth` 0: none.
GlFramebuffer createFramebuffer(const std::vector<Attachment>& colors, GLuint depth = 0);

/// Floats or words in rows of kTableWidth, four a texel. twin: shaders/lib/table.glsl.
inline constexpr uint32_t kTableWidth = 2048;
GlTexture createTable(std::span<const glm::vec4> values);
GlTexture createTable(std::span<const glm::uvec4> values);

/// Throws GlError with `doing` when GL reports an error ("out of video memory while ...").
void checkGl(const char* doing);

}  // namespace phat
