#pragma once
// Texels that are neighbours on a surface, and not in the atlas alone.

#include "core/atlas/atlas.h"

namespace phat {

/// Whether texel `to` of a chart lies from texel `from` as it does in the atlas, so that light may be
/// interpolated between them: true in one piece of surface, for charts are nearly isometric, and between
/// pieces of a surface that were laid as they lie; false between others. Pieces of two surfaces may have a
/// wall between them wherever they lie. Both texels must have a triangle.
inline bool lieTogether(const Atlas& atlas, const TexelPoints& points, size_t from, size_t to) {
    // Of the distance. Stretch may take .5 of it, and normals that are within the fits' cosine of .9 some .2.
    constexpr float kTolerance = 0.75f;
    if (atlas.triangleSurface[points.triangle[from]] != atlas.triangleSurface[points.triangle[to]])
        return false;
    const int width = int(atlas.sizeTexels.x);
    const glm::vec2 offset(int(to) % width - int(from) % width, int(to) / width - int(from) / width);
    const Chart& chart = atlas.charts[atlas.chartAt(from)];
    const glm::vec3 tangent = points.tangent[from];
    const glm::vec3 across = glm::cross(points.normal[from], tangent);
    const glm::vec3 expected = offset.x * tangent + (chart.back ? -offset.y : offset.y) * across;
    const glm::vec3 off = (points.position[to] - points.position[from]) / chart.texelSizeMeters - expected;
    return glm::dot(off, off) <= square(kTolerance) * glm::dot(offset, offset);
}

}  // namespace phat
