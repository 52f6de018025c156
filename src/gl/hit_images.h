#pragma once
// The pictures of all materials that rays read, as layers of one size: a shader cannot choose among textures.

#include <map>

#include "core/scene/scene.h"
#include "gl/gl_objects.h"

namespace phat {

/// A layer for a material that has none; twin: kNoLayer in shaders/lib/hit_surface.glsl.
inline constexpr uint32_t kNoLayer = 255;

struct HitImages {
    GlTexture colors;  // SRGB8_ALPHA8 array with mipmaps; one layer even without pictures
    GlTexture linear;  // RGBA8, as `colors`
    std::map<int32_t, uint32_t> colorLayers, linearLayers;  // by Scene::images
};

/// Pictures of base colour and of emission; of metallic and roughness, and of normals. They are shrunk as
/// kMaxHitImageBytes asks for; those beyond 255 have no layer. Throws GlError.
HitImages uploadHitImages(const Scene& scene);

/// Of each array.
inline constexpr uint64_t kMaxHitImageBytes = 64u << 20;

/// The mean of a slot's picture over all texels, as sampleTexture reads it; 1 without one.
glm::vec4 meanTexel(const Scene& scene, const TextureSlot& slot, bool srgb);

}  // namespace phat
