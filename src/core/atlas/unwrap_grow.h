#pragma once
// Cuts a surface into connected pieces that are flat enough to unroll.

#include <cstdint>
#include <span>
#include <vector>

#include "core/atlas/mesh_topology.h"
#include "core/base/progress.h"

namespace phat {

/// Splits `triangles`, which must be connected across edges and ascending, into connected pieces whose
/// normals stay within about the given cone around the piece's mean normal. Pieces and their triangles are
/// ascending. source: Cohen-Steiner et al. 2004, "Variational Shape Approximation" (alternating seeds and
/// growth by normal deviation), followed by merging as in Garland et al. 2001, "Hierarchical Face
/// Clustering".
std::vector<std::vector<uint32_t>> growCharts(const MeshTopology& topology,
                                              std::span<const uint32_t> triangles, double cosCone,
                                              const Progress& progress);

/// Splits a connected piece of at least two triangles in two connected halves of similar area.
std::vector<std::vector<uint32_t>> bisectChart(const MeshTopology& topology,
                                               std::span<const uint32_t> triangles);

/// The pieces of `triangles` that hang together across edges; each ascending, ordered by first triangle.
std::vector<std::vector<uint32_t>> connectedPieces(const MeshTopology& topology,
                                                   std::span<const uint32_t> triangles);

}  // namespace phat
