#include "core/probes/probe_grid.h"

#include <algorithm>

namespace phat {
namespace {

// The outer corners of the grid are moved inward by this fraction of a cell, off the walls.
constexpr float kInset = 0.125f;
// Less than this fraction of the mean is no light: what comes through cracks of a model.
constexpr float kMinLight = 1e-4f;

glm::ivec3 cornerStep(uint32_t corner) {
    return glm::ivec3(corner & 1u, corner >> 1 & 1u, corner >> 2);
}

int stepsOf(int division) {
    return kGridSteps >> division;
}

float meanLight(const std::vector<ProbeRays>& probes) {
    double sum = 0;
    for (const ProbeRays& probe : probes) sum += double(lightOf(probe));
    return float(sum / double(std::max<size_t>(probes.size(), 1)));
}

// Of the luminance of all coefficients: how far the corners are from their mean, over the light there and in
// the room.
float changeOfLight(const ProbeGrid::Cell& cell, const std::vector<ProbeRays>& probes, float meanOfAll) {
    float change = 0, light = 0;
    for (int term = 0; term < kShTerms; ++term) {
        std::array<float, 8> value{};
        float mean = 0;
        for (size_t i = 0; i < 8; ++i) {
            const ProbeRays& probe = probes[cell.corner[i]];
            value[i] = luminance(probe.indirect.coefficient[term] + probe.area.coefficient[term]);
            mean += value[i] / 8;
        }
        if (term == 0) light = mean;
        for (const float v : value) change += square(v - mean) / 8;
    }
    return std::sqrt(change) / std::max(light + meanOfAll, 1e-30f);
}

}  // namespace

float lightOf(const ProbeRays& probe) {
    return luminance(probe.indirect.coefficient[0] + probe.area.coefficient[0]);
}

uint64_t ProbeGrid::keyOf(glm::ivec3 step) const {
    const glm::uvec3 size = gridSize * uint32_t(kGridSteps) + 1u;
    return (uint64_t(step.z) * size.y + uint64_t(step.y)) * size.x + uint64_t(step.x);
}

glm::vec3 ProbeGrid::positionOf(const GridCorner& corner) const {
    return lowWorld + glm::vec3(corner.step) / float(kGridSteps) * cellMeters;
}

uint32_t ProbeGrid::cornerAt(glm::ivec3 step, int division) {
    const auto [found, isNew] = numbers_.try_emplace(keyOf(step), uint32_t(corners.size()));
    if (isNew) corners.push_back({step, division});
    return found->second;
}

void ProbeGrid::addCell(glm::ivec3 step, int division) {
    Cell cell{step, division, {}, 0};
    for (uint32_t i = 0; i < 8; ++i)
        cell.corner[i] = cornerAt(step + stepsOf(division) * cornerStep(i), division);
    cells.push_back(cell);
}

int ProbeGrid::newCorners(const Cell& cell) const {
    const int half = stepsOf(cell.division + 1);
    int count = 0;
    for (int i = 0; i < 27; ++i)
        count += !numbers_.contains(keyOf(cell.step + half * glm::ivec3(i % 3, i / 3 % 3, i / 9)));
    return count;
}

void ProbeGrid::divide(size_t index) {
    const Cell parent = cells[index];
    cells[index].firstChild = uint32_t(cells.size());
    for (uint32_t i = 0; i < 8; ++i)
        addCell(parent.step + stepsOf(parent.division + 1) * cornerStep(i), parent.division + 1);
}

ProbeGrid layOutGrid(const Bounds& box, size_t corners) {
    ProbeGrid grid;
    const glm::vec3 size = glm::max(box.high - box.low, glm::vec3(1e-3f * box.diagonal()));
    const auto cellsFor = [&](float side) { return glm::max(glm::uvec3(glm::round(size / side)), 1u); };
    const auto count = [](glm::uvec3 n) { return uint64_t(n.x + 1) * (n.y + 1) * (n.z + 1); };
    constexpr float kRatio = 1.02f;  // from one size of the cells to the next
    float side = std::cbrt(size.x * size.y * size.z / float(std::max<size_t>(corners, 1)));
    while (count(cellsFor(side)) > std::max<size_t>(corners, 8)) side *= kRatio;
    grid.gridSize = cellsFor(side);
    const glm::vec3 margin = kInset * size / glm::vec3(grid.gridSize);
    grid.lowWorld = box.low + margin;
    grid.cellMeters = (size - 2.0f * margin) / glm::vec3(grid.gridSize);
    for (uint32_t z = 0; z < grid.gridSize.z; ++z)
        for (uint32_t y = 0; y < grid.gridSize.y; ++y)
            for (uint32_t x = 0; x < grid.gridSize.x; ++x) grid.addCell(kGridSteps * glm::ivec3(x, y, z), 0);
    return grid;
}

std::vector<size_t> cellsToDivide(const ProbeGrid& grid, const std::vector<ProbeRays>& probes, int division,
                                  size_t corners) {
    const float mean = meanLight(probes);
    std::vector<std::pair<float, size_t>> changes;
    for (size_t i = 0; i < grid.cells.size(); ++i)
        if (grid.cells[i].division == division)
            changes.emplace_back(-changeOfLight(grid.cells[i], probes, mean), i);
    std::sort(changes.begin(), changes.end());
    ProbeGrid trial = grid;
    std::vector<size_t> chosen;
    for (const auto& [change, cell] : changes) {
        if (change >= 0.0f) break;
        if (trial.corners.size() - grid.corners.size() + size_t(trial.newCorners(trial.cells[cell])) >
            corners)
            break;
        trial.divide(cell);
        chosen.push_back(cell);
    }
    return chosen;
}

namespace {

// Numbers the corners that cells with light need.
struct PackedNumbers {
    std::vector<uint16_t> ofCorner;  // kNoProbe: not needed
    std::vector<uint32_t> corners;   // that are, in the order of their numbers

    uint16_t of(uint32_t corner) {
        if (ofCorner[corner] == kNoProbe) {
            ofCorner[corner] = uint16_t(corners.size());
            corners.push_back(corner);
        }
        return ofCorner[corner];
    }
};

}  // namespace

LightProbes packProbes(const ProbeGrid& grid, const std::vector<ProbeRays>& probes) {
    LightProbes packed;
    packed.lowWorld = grid.lowWorld;
    packed.cellMeters = grid.cellMeters;
    packed.gridSize = grid.gridSize;
    const float least = kMinLight * meanLight(probes);
    bool area = false;
    for (const ProbeRays& probe : probes) area |= maxComponent(probe.area.coefficient[0]) > 0.0f;

    PackedNumbers numbers{std::vector<uint16_t>(grid.corners.size(), kNoProbe), {}};
    for (const ProbeGrid::Cell& cell : grid.cells) {
        ProbeCell out;
        out.fill(kNoProbe);
        if (cell.firstChild != 0) {
            out[0] = kDividedCell;
            out[1] = uint16_t(cell.firstChild);
            out[2] = uint16_t(cell.firstChild >> 16);
        } else if (std::any_of(cell.corner.begin(), cell.corner.end(),
                               [&](uint32_t corner) { return lightOf(probes[corner]) > least; })) {
            for (size_t i = 0; i < 8; ++i) out[i] = numbers.of(cell.corner[i]);
        }
        packed.cells.push_back(out);
    }
    const float unit = packed.unitMeters();
    for (const uint32_t corner : numbers.corners) {
        const ProbeRays& probe = probes[corner];
        const ProbeDistances distances = packDistances(probe.reciprocalDistance, unit);
        packed.places.push_back(
            packPlace(probe.position - grid.positionOf(grid.corners[corner]), distances.rangeCode, unit));
        packed.distances.push_back(distances.code);
        packed.indirect.push_back(packIrradianceSh(probe.indirect));
        if (area) packed.area.push_back(packIrradianceSh(probe.area));
    }
    return packed;
}

}  // namespace phat
