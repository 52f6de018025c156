#pragma once
// How far a probe sees: the reciprocal distance to the nearest surface by direction, on an octahedron.
//
// A point is measured by v, its place on the octahedron |x| + |y| + |z| = 1, and by its distance t in that
// norm: it is t v. A plane n.p = h is seen at 1 / t = n.v / h, which is linear in v; so reciprocal distances
// interpolated over the triangles of a divided octahedron are exact for a wall, and between walls of a convex
// room the nearer wins. Means of distances and of their squares, as in Majercik et al. 2019 ("Dynamic Diffuse
// Global Illumination with Ray-Traced Irradiance Fields"), take twice the bytes and let light through behind
// walls that are seen aslant. ours.

#include <array>
#include <cstdint>

#include "core/base/math.h"

namespace phat {

/// Intervals of half an edge of the octahedron unfolded to a square, and nodes along all of that edge.
inline constexpr int kDistanceIntervals = 3;
inline constexpr int kDistanceNodes = 2 * kDistanceIntervals + 1;

/// The direction of a node of the square, row by row; not normalised: on the octahedron.
glm::vec3 distanceNode(int index);

/// Reciprocal distances of the nodes, [y][x], a byte each: multiples of the largest over 255.
struct ProbeDistances {
    std::array<uint8_t, kDistanceNodes * kDistanceNodes> code{};
    /// Of the largest, over the volume's unit: 2^(rangeCode / 16 - 4).
    uint8_t rangeCode = 0;
};

/// `reciprocal`: of the nodes, per metre in the octahedron's norm, 0 where nothing is met. `unitMeters`: of
/// the range.
ProbeDistances packDistances(const std::array<float, kDistanceNodes * kDistanceNodes>& reciprocal,
                             float unitMeters);

/// The weight of a probe for a point that is `offset` from it: 1 before the surfaces around the probe; from a
/// few per cent of their distance behind them next to nothing, and less the farther behind. So points that no
/// probe sees, as in the corners of rooms, where nodes see different walls, have the light of the probes that
/// nearly do.
float probeVisibility(const ProbeDistances& distances, glm::vec3 offset, float unitMeters);

}  // namespace phat
