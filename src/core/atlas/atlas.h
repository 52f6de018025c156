#pragma once
// The atlas: a one-to-one map from the scene's triangles to texels.
//
// Charts are near-isometric, of one piece or several near ones, and own whole tiles of 8x8, so that nothing
// on tiles ever mixes two charts. Texel (x, y) has its centre at (x + .5, y + .5); row 0 is uv.v = 0.

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/scene/rays.h"
#include "core/scene/scene.h"

namespace phat {

inline constexpr uint32_t kTileSize = 8;    // texels
inline constexpr uint32_t kBlockSize = 32;  // texels; blocks are anchored at their chart's origin
inline constexpr uint32_t kNoChart = ~0u;
inline constexpr double kFillFreedom = 1.05;  // how much finer or coarser a chart may be to fill its tiles

struct Chart {
    glm::uvec2 originTile{0};  // in tiles
    glm::uvec2 sizeTiles{0};
    float texelSizeMeters = 0;      // side of its texels on the surface
    uint32_t surface = 0;           // Scene::surfaces: of its first piece; the others are of the same node
    uint32_t firstBlock = 0;        // blocks are numbered row by row within a chart
    bool back = false;              // texels face away from the triangles' front
    uint32_t otherSide = kNoChart;  // the same triangles' opposite side, of the same sizes, if it has texels

    glm::uvec2 originTexel() const { return originTile * kTileSize; }
    glm::uvec2 sizeTexels() const { return sizeTiles * kTileSize; }
    uint32_t blocksWide() const { return (sizeTexels().x + kBlockSize - 1) / kBlockSize; }
    uint32_t blocksHigh() const { return (sizeTexels().y + kBlockSize - 1) / kBlockSize; }
};

struct Atlas {
    glm::uvec2 sizeTexels{0};   // multiples of kTileSize
    float texelSizeMeters = 0;  // of the coarsest charts; those of glossy surfaces have finer ones
    float unitMeters = 1;       // lengthUnit() of the scene: stored distances are multiples of it
    std::vector<Chart> charts;
    std::vector<uint32_t> triangleChart;                   // per triangle; kNoChart: degenerate
    std::vector<uint32_t> triangleSurface;                 // per triangle, as the scene's
    std::vector<std::array<glm::vec2, 3>> triangleTexels;  // per triangle corner, in texels of that chart
    std::vector<uint32_t> tileChart;                       // [tileY][tileX], kNoChart where empty
    uint32_t blockCount = 0;

    float finestTexelSizeMeters() const {
        float finest = texelSizeMeters;
        for (const Chart& chart : charts) finest = std::min(finest, chart.texelSizeMeters);
        return finest;
    }
    glm::uvec2 sizeTiles() const { return sizeTexels / kTileSize; }
    size_t texelCount() const { return size_t(sizeTexels.x) * sizeTexels.y; }
    uint32_t chartAt(glm::uvec2 texel) const {
        return tileChart[size_t(texel.y / kTileSize) * sizeTiles().x + texel.x / kTileSize];
    }
    /// `texel`: index into an array of [y][x].
    uint32_t chartAt(size_t texel) const { return chartAt({texel % sizeTexels.x, texel / sizeTexels.x}); }
    /// pre: the texel's tile has a chart.
    float texelMetersAt(size_t texel) const {
        assert(chartAt(texel) != kNoChart);
        return charts[chartAt(texel)].texelSizeMeters;
    }
    /// Block of a texel. pre: the texel's tile has a chart.
    uint32_t blockAt(glm::uvec2 texel) const {
        assert(chartAt(texel) != kNoChart);
        const Chart& chart = charts[chartAt(texel)];
        const glm::uvec2 block = (texel - chart.originTexel()) / kBlockSize;
        return chart.firstBlock + block.y * chart.blocksWide() + block.x;
    }
};

/// Which sides of a connected piece of surface deserve texels.
enum class Sides : uint8_t { front, back, both };

struct AtlasSettings {
    float texelSizeMeters = 0;        // of rough surfaces; 0: from texelBudget
    uint64_t texelBudget = 1 << 20;   // about how many texels the whole atlas may have
    float glossyDensity = 3;          // texels of glossy surfaces are up to this factor finer; 1..8
    float maxNormalConeDegrees = 40;  // charts stop growing where normals leave this cone
    uint32_t gutterTexels = 4;        // around every chart of one piece
    uint32_t maxSizeTexels = 16384;   // per side
    int useUvSet = -1;                // >= 0: take the charts of this UV set instead of unwrapping
};

/// Facts for the log and for tests.
struct AtlasStats {
    uint32_t chartCount = 0;
    float coverage = 0;             // coverageOf()
    float areaWithinStretch15 = 0;  // fraction of the unwrapped area whose L2-independent stretch is <= 1.5
    uint32_t degenerateTriangles = 0;
    uint32_t keptCharts = 0;  // of an earlier atlas: these come first, and were not unwrapped
};

/// Connected components over shared positions (welded), per triangle, numbered from 0 in triangle order.
/// Triangles of different surfaces are never connected.
std::vector<uint32_t> connectedComponents(const Scene& scene);

/// Unwraps and packs. `componentSides` is per connected component (empty: front everywhere).
/// With a texel budget, finer texels on glossy surfaces make the others' at most a quarter larger, and a
/// chart may be kFillFreedom finer or coarser than others like it, to fill its tiles. Throws
/// std::runtime_error with the reason when a requested UV set cannot serve, std::invalid_argument if
/// glossyDensity is out of range.
Atlas buildAtlas(const Scene& scene, const std::vector<Sides>& componentSides, const AtlasSettings& settings,
                 Progress& progress, AtlasStats* stats = nullptr);

/// The same; with a texel budget, pieces that nobody sees have fewer texels.
Atlas buildAtlas(const RayScene& rays, const std::vector<Sides>& componentSides,
                 const AtlasSettings& settings, Progress& progress, AtlasStats* stats = nullptr);

/// The texels of a block that its chart has.
struct BlockRect {
    glm::uvec2 origin;  // texel
    glm::uvec2 size;    // texels, at most kBlockSize
};
/// [block]
std::vector<BlockRect> blockRects(const Atlas& atlas);

/// Recomputes firstBlock and blockCount from the charts' sizes (after loading).
void numberBlocks(Atlas& atlas);

enum class TexelState : uint8_t {
    unused,    // no chart, or too far from its chart's edge
    surface,   // centre inside a triangle
    gutter,    // extended past the edge (Hensley et al. 2003, section 4.2)
    occluded,  // inside or pressed against other geometry: never carries light
};

/// Where each texel is in the world. All arrays are [y][x] of the atlas.
struct TexelPoints {
    glm::uvec2 sizeTexels{0};
    std::vector<TexelState> state;
    std::vector<glm::vec3> position;     // gutters: extrapolated
    std::vector<glm::vec3> normal;       // unit, interpolated vertex normals, on the chart's side
    std::vector<glm::vec3> tangent;      // unit, along growing atlas x, orthogonal to the normal
    std::vector<uint32_t> triangle;      // kNoTriangle where unused
    std::vector<glm::vec2> barycentric;  // gutters: outside the triangle

    bool valid(size_t texel) const {
        return state[texel] == TexelState::surface || state[texel] == TexelState::gutter;
    }
};

/// Unit normal of the flat triangle under a texel, on the chart's side. pre: `points` of the scene and the
/// atlas, valid there.
glm::vec3 flatNormalOf(const Scene& scene, const Atlas& atlas, const TexelPoints& points, size_t texel);

/// Rasterises the atlas and extends the charts into their gutters. Deterministic: the baked file does not
/// store it. States are unused, surface or gutter.
TexelPoints buildTexelPoints(const Scene& scene, const Atlas& atlas);

/// Marks as occluded the texels of which at least half the hemisphere is the dark side of something (a side
/// of a triangle without texels), those that something is pressed against, and the gutters that reach through
/// geometry. `rays` must be of the atlas's scene.
void markOccludedTexels(TexelPoints& points, const Atlas& atlas, const RayScene& rays, Progress& progress);
/// Whether it would mark one texel, which must be valid in `points`.
bool isOccludedTexel(const TexelPoints& points, const Atlas& atlas, const RayScene& rays, size_t texel);

/// Frame of each block: mean normal and tangent of its texels. Directions of a block's PHATexels are stored
/// in it, so that they follow the surface when it moves.
std::vector<Frame> blockFrames(const Atlas& atlas, const TexelPoints& points);

}  // namespace phat
