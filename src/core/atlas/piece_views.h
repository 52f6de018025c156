#pragma once
// What pieces of surface see: nothing, other surfaces, the sky.

#include <span>
#include <vector>

#include "core/atlas/atlas.h"
#include "core/atlas/unwrap.h"
#include "core/scene/rays.h"

namespace phat {

/// A piece with the sides that have texels.
struct SidedPieces {
    std::span<const FlatChart> flats;
    std::span<const Sides> sides;           // per piece
    std::span<const uint32_t> component;    // per triangle; empty: all front
    std::span<const Sides> componentSides;  // per component
};

/// How fine the texels of hidden pieces are, over those of others.
inline constexpr double kHiddenDensity = 0.25;

struct PieceView {
    /// Nearly all of its texels would be occluded, on all sides that have texels: the faces of floor boards
    /// between each other, the undersides of what stands, the insides of solids.
    bool hidden = false;
    /// Equal for pieces that see about as much of the sky: none, some of it as from inside a room with a
    /// window, or much.
    uint8_t sky = 0;
};

/// Per piece.
std::vector<PieceView> viewsOfPieces(const RayScene& rays, const SidedPieces& pieces, double texelSizeMeters,
                                     const Progress& progress);

}  // namespace phat
