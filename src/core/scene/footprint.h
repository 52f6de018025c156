#pragma once
// Textures averaged over what a ray stands for, as the rasteriser filters them: of surfaces that rays show in
// place of pixels. Without it, lines narrower than a pixel are drawn as dashes by a few rays.

#include <vector>

#include "core/scene/shading.h"

namespace phat {

/// The images of a scene at half the size, a quarter and so on, down to one texel: means of 2x2 texels, of
/// linear values where the texture is a colour.
class TextureLevels {
  public:
    explicit TextureLevels(const Scene& scene);

    bool empty() const { return levels_.empty(); }
    /// `level` from 0, the image itself; the last one where there are fewer.
    const TextureImage& at(const Scene& scene, int32_t image, bool srgb, int level) const;

  private:
    std::vector<std::vector<TextureImage>>
        levels_;  // [2 * image + srgb]; empty where no material asks for it
};

/// What a hit stands for.
struct Footprint {
    const TextureLevels& levels;
    glm::vec3 sides[2];  // of a parallelogram in the plane of the hit's triangle, world
};

/// As without a footprint (core/scene/shading.h), but its textures are means: of as many as
/// kMaxFootprintSamples lookups between two levels along the footprint's longer axis, each as wide as the
/// shorter one, so that a surface that is seen at a grazing angle is not blurred along it.
/// source: the filter of EXT_texture_filter_anisotropic.
SurfacePoint surfaceAt(const Scene& scene, const Hit& hit, glm::vec3 direction, const Footprint& footprint);

inline constexpr int kMaxFootprintSamples = 8;

/// One texture. `sides`: of the footprint, in the coordinates of `uv`.
glm::vec4 sampleTexture(const Scene& scene, const TextureSlot& slot, glm::vec2 uv, bool srgb,
                        const TextureLevels& levels, const glm::vec2 (&sides)[2]);

}  // namespace phat
