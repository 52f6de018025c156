#pragma once
// Texels that are neighbours on a surface, and not in the atlas alone.

#include "core/atlas/atlas.h"

namespace phat {

/// The plane of a texel, on which its neighbours are expected. pre: it has a triangle.
class TexelPlane {
  public:
    TexelPlane(const Atlas& atlas, const TexelPoints& points, size_t texel)
        : atlas_(atlas),
          points_(points),
          surface_(atlas.triangleSurface[points.triangle[texel]]),
          chart_(atlas.charts[atlas.chartAt(texel)]),
          position_(points.position[texel]),
          tangent_(points.tangent[texel]),
          across_(glm::cross(points.normal[texel], tangent_)) {}

    /// Whether another texel of the chart lies from this one as it does in the atlas, `offset` texels away,
    /// so that light may be interpolated between them: true in one piece of surface, for charts are nearly
    /// isometric, and between pieces of a surface that were laid as they lie; false between others. Pieces of
    /// two surfaces may have a wall between them wherever they lie. pre: the other texel has a triangle.
    bool has(size_t other, glm::vec2 offset) const {
        // Of the distance. Stretch may take .5 of it, and normals within the fits' cosine of .9 some .2.
        constexpr float kTolerance = 0.75f;
        if (atlas_.triangleSurface[points_.triangle[other]] != surface_) return false;
        const glm::vec3 expected = offset.x * tangent_ + (chart_.back ? -offset.y : offset.y) * across_;
        const glm::vec3 off = (points_.position[other] - position_) / chart_.texelSizeMeters - expected;
        return glm::dot(off, off) <= square(kTolerance) * glm::dot(offset, offset);
    }

  private:
    const Atlas& atlas_;
    const TexelPoints& points_;
    uint32_t surface_;
    const Chart& chart_;
    glm::vec3 position_, tangent_, across_;
};

/// TexelPlane::has for one pair of a chart's texels.
inline bool lieTogether(const Atlas& atlas, const TexelPoints& points, size_t from, size_t to) {
    const int width = int(atlas.sizeTexels.x);
    const glm::vec2 offset(int(to) % width - int(from) % width, int(to) / width - int(from) / width);
    return TexelPlane(atlas, points, from).has(to, offset);
}

}  // namespace phat
