#pragma once
// Irradiance that does not jump where charts meet.

#include <array>
#include <vector>

#include "core/bake/irradiance.h"

namespace phat {

/// A point on an edge of the mesh that the atlas has cut, with its position in the charts on both sides.
struct SeamPoint {
    std::array<uint32_t, 2> chart;
    std::array<glm::vec2, 2> position;  // in the atlas, texels
    float weight = 0;                   // length of the edge that it represents, in the finer chart's texels
};

/// Points along all edges that two triangles of one surface share in the mesh but not in the atlas, about two
/// a texel; each lit side has its own. Edges at which the shading normals part are left out: light jumps
/// there in truth.
std::vector<SeamPoint> findSeams(const Scene& scene, const Atlas& atlas);

/// What the renderer reads at a point: bilinear between the texels of the chart.
/// twin: irradianceAt in shaders/display.frag.
glm::vec3 irradianceAt(const IrradianceMap& map, const Atlas& atlas, uint32_t chart, glm::vec2 position);

/// Changes the texels around the seams as little as makes both sides' bilinear values equal there: linear
/// least squares, by conjugate gradients. `map` is filled; texels that do not receive light are freer to
/// change, those within `spreadTexels` of a seam are unknowns. No value falls below 0. Throws Interrupted
/// when asked to stop. source: Iwanicki 2013, "Lighting Technology of The Last of Us".
void stitchSeams(IrradianceMap& map, const std::vector<SeamPoint>& seams, const ReceiverTexels& texels,
                 float spreadTexels, const Progress& progress);

}  // namespace phat
