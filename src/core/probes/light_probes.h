#pragma once
// Light for objects that were not in the bake: irradiance by normal at points between the surfaces.

#include <array>
#include <cstdint>
#include <vector>

#include "core/probes/probe_distances.h"
#include "core/probes/probe_sh.h"

namespace phat {

/// A cell of the grid, or of a divided cell: the probes at its corners, bit 0 of a corner's number for x, bit
/// 1 for y, bit 2 for z. A divided one has kDividedCell, then the number of its first child (low and high 16
/// bits); its eight children follow each other in the order of the corners that they touch.
using ProbeCell = std::array<uint16_t, 8>;
inline constexpr uint16_t kNoProbe = 0xffff;  // all eight: the cell is dark
inline constexpr uint16_t kDividedCell = 0xfffe;
inline constexpr size_t kMaxProbes = 0xfff0;
/// How often a cell of the grid is divided at most.
inline constexpr int kMaxCellDivisions = 2;

/// Where a probe is, relative to its corner, and the range of its distances: x, y and z as signed bytes, 127
/// of them a quarter of LightProbes::unitMeters(), then ProbeDistances::rangeCode.
using PackedPlace = uint32_t;

/// A grid of cubes or boxes over a room, divided in two where light changes. What a probe holds is what the
/// bake's surfaces receive (Phatexture): indirect light, and light straight from emissive surfaces and the
/// environment; not that of punctual lights.
struct LightProbes {
    glm::vec3 lowWorld{0};  // metres; the first corner of the grid
    glm::vec3 cellMeters{1};
    glm::uvec3 gridSize{0};        // cells
    std::vector<ProbeCell> cells;  // those of the grid, x first, then y; then children
    std::vector<PackedPlace> places;
    std::vector<PackedIrradianceSh> indirect;
    std::vector<PackedIrradianceSh> area;  // empty where nothing but punctual lights shines
    std::vector<std::array<uint8_t, kDistanceNodes * kDistanceNodes>> distances;

    size_t count() const { return places.size(); }
    float unitMeters() const { return std::max({cellMeters.x, cellMeters.y, cellMeters.z}); }
};

PackedPlace packPlace(glm::vec3 offset, uint8_t rangeCode, float unitMeters);
/// Metres, from the corner.
glm::vec3 placeOffset(PackedPlace place, float unitMeters);

/// W/m2; the parts as in Phatexture.
struct ProbeIrradiance {
    glm::vec3 indirect{0};
    glm::vec3 area{0};
};

/// Irradiance of a surface with this normal: trilinear between the corners of the cell that the point is in,
/// and of these by those that see it. Points outside the grid have the nearest cell's. pre: |normal| = 1.
/// twin: probeIrradiance in shaders/lib/probe_light.glsl.
ProbeIrradiance probeIrradianceAt(const LightProbes& probes, glm::vec3 position, glm::vec3 normal);

/// Whether cells and probes refer to what there is, in a way that a lookup ends.
bool isConsistent(const LightProbes& probes);

/// Of the arrays, as a file holds them before compression.
uint64_t probeBytes(const LightProbes& probes);

}  // namespace phat
