#pragma once
// Where probes stand: a grid whose cells are divided where light changes.

#include <map>

#include "core/probes/probe_gather.h"
#include "core/scene/scene.h"

namespace phat {

/// Corners by their place in steps of the smallest cell, of which a cell of the grid has kGridSteps a side.
inline constexpr int kGridSteps = 1 << kMaxCellDivisions;
struct GridCorner {
    glm::ivec3 step{0};
    int division = 0;  // of the cells that asked for it first: 0 for those of the grid
};

/// A grid while it is filled. Corners are numbered in the order in which they were asked for.
struct ProbeGrid {
    glm::vec3 lowWorld{0};
    glm::vec3 cellMeters{1};
    glm::uvec3 gridSize{0};
    std::vector<GridCorner> corners;

    struct Cell {
        glm::ivec3 step{0};  // of the low corner
        int division = 0;
        std::array<uint32_t, 8> corner{};
        uint32_t firstChild = 0;  // 0: undivided
    };
    std::vector<Cell> cells;  // those of the grid first, x first, then y

    glm::vec3 positionOf(const GridCorner& corner) const;
    /// A new number where there is no corner yet.
    uint32_t cornerAt(glm::ivec3 step, int division);
    void addCell(glm::ivec3 step, int division);
    /// How many corners dividing a cell would add.
    int newCorners(const Cell& cell) const;
    /// Appends eight children, with their corners.
    void divide(size_t cell);

  private:
    uint64_t keyOf(glm::ivec3 step) const;
    std::map<uint64_t, uint32_t> numbers_;
};

/// A grid over `box` with about `corners` corners, and no more; they are moved inward from its sides.
ProbeGrid layOutGrid(const Bounds& box, size_t corners);

/// Of the cells that were divided `division` times: those whose light changes most, until `corners` more
/// corners would be exceeded. `probes`: of all corners. `meanLight`: of them all, as lightOf().
std::vector<size_t> cellsToDivide(const ProbeGrid& grid, const std::vector<ProbeRays>& probes, int division,
                                  size_t corners);

/// Luminance of the mean irradiance.
float lightOf(const ProbeRays& probe);

/// Packs what cells with light need.
LightProbes packProbes(const ProbeGrid& grid, const std::vector<ProbeRays>& probes);

}  // namespace phat
