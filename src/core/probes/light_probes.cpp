#include "core/probes/light_probes.h"

namespace phat {
namespace {

constexpr float kOffsetFraction = 0.25f;  // of the unit: 127 steps of a place

struct CellPlace {
    const ProbeCell* cell;
    glm::vec3 low;
    glm::vec3 size;
};

uint32_t firstChild(const ProbeCell& cell) {
    return cell[1] | uint32_t(cell[2]) << 16;
}

// The undivided cell that a point is in, or that is nearest.
CellPlace cellAt(const LightProbes& probes, glm::vec3 position) {
    const glm::vec3 at = (position - probes.lowWorld) / probes.cellMeters;
    const glm::vec3 last(probes.gridSize - 1u);
    const glm::vec3 grid = glm::clamp(glm::floor(at), glm::vec3(0), last);
    const glm::uvec3 g(grid);
    CellPlace place{&probes.cells[(size_t(g.z) * probes.gridSize.y + g.y) * probes.gridSize.x + g.x],
                    probes.lowWorld + grid * probes.cellMeters, probes.cellMeters};
    for (int division = 0; division < kMaxCellDivisions && (*place.cell)[0] == kDividedCell; ++division) {
        place.size *= 0.5f;
        uint32_t child = firstChild(*place.cell);
        for (int axis = 0; axis < 3; ++axis) {
            if (position[axis] < place.low[axis] + place.size[axis]) continue;
            place.low[axis] += place.size[axis];
            child += 1u << axis;
        }
        place.cell = &probes.cells[child];
    }
    return place;
}

}  // namespace

PackedPlace packPlace(glm::vec3 offset, uint8_t rangeCode, float unitMeters) {
    PackedPlace packed = uint32_t(rangeCode) << 24;
    for (int axis = 0; axis < 3; ++axis) {
        const float code = std::round(127 * offset[axis] / (kOffsetFraction * unitMeters));
        packed |= uint32_t(uint8_t(int8_t(std::clamp(code, -127.0f, 127.0f)))) << 8 * axis;
    }
    return packed;
}

glm::vec3 placeOffset(PackedPlace place, float unitMeters) {
    glm::vec3 offset;
    for (int axis = 0; axis < 3; ++axis)
        offset[axis] = float(int8_t(place >> 8 * axis & 0xffu)) / 127 * kOffsetFraction * unitMeters;
    return offset;
}

ProbeIrradiance probeIrradianceAt(const LightProbes& probes, glm::vec3 position, glm::vec3 normal) {
    ProbeIrradiance sum;
    if (probes.cells.empty()) return sum;
    const CellPlace in = cellAt(probes, position);
    if ((*in.cell)[0] == kDividedCell) return sum;
    const glm::vec3 at = glm::clamp((position - in.low) / in.size, glm::vec3(0), glm::vec3(1));
    const float unit = probes.unitMeters();
    float weights = 0;
    for (uint32_t corner = 0; corner < 8; ++corner) {
        const uint16_t probe = (*in.cell)[corner];
        if (probe == kNoProbe) continue;
        const glm::vec3 side(corner & 1u, corner >> 1 & 1u, corner >> 2);
        const glm::vec3 along = glm::mix(1.0f - at, at, side);
        const glm::vec3 from = in.low + side * in.size + placeOffset(probes.places[probe], unit);
        const ProbeDistances distances{probes.distances[probe], uint8_t(probes.places[probe] >> 24)};
        const float weight = along.x * along.y * along.z * probeVisibility(distances, position - from, unit);
        sum.indirect += weight * unpackIrradianceSh(probes.indirect[probe]).at(normal);
        if (!probes.area.empty()) sum.area += weight * unpackIrradianceSh(probes.area[probe]).at(normal);
        weights += weight;
    }
    if (weights <= 0.0f) return {};
    return {sum.indirect / weights, sum.area / weights};
}

bool isConsistent(const LightProbes& probes) {
    const size_t count = probes.count();
    const uint64_t grid = uint64_t(probes.gridSize.x) * probes.gridSize.y * probes.gridSize.z;
    if (count > kMaxProbes || probes.indirect.size() != count || probes.distances.size() != count ||
        (!probes.area.empty() && probes.area.size() != count) || grid > probes.cells.size())
        return false;
    for (size_t i = 0; i < probes.cells.size(); ++i) {
        const ProbeCell& cell = probes.cells[i];
        // Children come after their parents, so that no way leads back.
        if (cell[0] == kDividedCell) {
            if (firstChild(cell) <= i || uint64_t(firstChild(cell)) + 8 > probes.cells.size()) return false;
            continue;
        }
        for (const uint16_t probe : cell)
            if (probe != kNoProbe && probe >= count) return false;
    }
    return true;
}

uint64_t probeBytes(const LightProbes& probes) {
    return probes.cells.size() * sizeof(ProbeCell) +
           probes.count() * (sizeof(PackedPlace) + sizeof(probes.distances[0])) +
           (probes.indirect.size() + probes.area.size()) * sizeof(PackedIrradianceSh);
}

}  // namespace phat
