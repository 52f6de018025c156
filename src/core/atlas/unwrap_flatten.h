#pragma once
// One chart to the plane.

#include <vector>

#include "core/atlas/chart_mesh.h"

namespace phat {

/// Parametrises near-isometrically without flips, in metres, with the surface's area: orthographic projection
/// along the mean normal, exact where the chart is planar; elsewhere made isometric by as-rigid-as-possible
/// iterations. Never worse than the projection. pre: no normal is 90 degrees or more off the mean; otherwise,
/// and where overlaps remain, `isInjective` says so.
/// source: Liu et al. 2008, "A Local/Global Approach to Mesh Parameterization".
std::vector<glm::dvec2> flattenChart(const ChartMesh& mesh);

/// Corners of the convex hull, counter-clockwise; the first is the last, too.
/// source: Andrew 1979, "Another efficient algorithm for convex hulls in two dimensions".
std::vector<glm::dvec2> convexHull(std::vector<glm::dvec2> points);

/// Turns and shifts the chart so that its smallest bounding box is [0, w] x [0, h] with w >= h; returns (w,
/// h).
glm::dvec2 alignToBox(std::vector<glm::dvec2>& uv);

/// Whether no two triangles overlap: none is flipped, no vertex is wound twice, and the outline neither
/// crosses itself nor winds twice around its inside. That is sufficient: the number of triangles over a point
/// of the plane only changes across the outline.
bool isInjective(const ChartMesh& mesh, const std::vector<glm::dvec2>& uv);

}  // namespace phat
