#include "io/phat/probes_payload.h"

#include <array>
#include <cmath>

namespace phat {
namespace {

using nlohmann::json;

[[noreturn]] void refuseProbes(const char* reason) {
    throw std::runtime_error(reason);
}

glm::vec3 readVector(const json& object, const char* key) {
    const auto v = object.at(key).get<std::array<float, 3>>();
    for (const float x : v)
        if (!std::isfinite(x)) refuseProbes("the grid of the probes is not finite");
    return {v[0], v[1], v[2]};
}

}  // namespace

json describeProbes(const LightProbes& p) {
    return {{"low", {p.lowWorld.x, p.lowWorld.y, p.lowWorld.z}},
            {"cellSize", {p.cellMeters.x, p.cellMeters.y, p.cellMeters.z}},
            {"grid", {p.gridSize.x, p.gridSize.y, p.gridSize.z}},
            {"cellCount", p.cells.size()},
            {"count", p.count()}};
}

LightProbes readLightProbes(PayloadReader& reader, const json& extension) {
    LightProbes probes;
    if (!extension.contains("probes")) return probes;
    const json& object = extension["probes"];
    probes.lowWorld = readVector(object, "low");
    probes.cellMeters = readVector(object, "cellSize");
    for (int axis = 0; axis < 3; ++axis)
        if (!(probes.cellMeters[axis] > 0)) refuseProbes("a side of the probes' cells is not positive");
    const auto grid = object.at("grid").get<std::array<double, 3>>();
    for (int axis = 0; axis < 3; ++axis) {
        if (!(grid[size_t(axis)] >= 1 && grid[size_t(axis)] <= double(kMaxProbes)) ||
            grid[size_t(axis)] != std::floor(grid[size_t(axis)]))
            refuseProbes("the grid of the probes has an impossible size");
        probes.gridSize[axis] = uint32_t(grid[size_t(axis)]);
    }
    const uint64_t count = wholeNumber(object, "count");
    if (count > kMaxProbes) refuseProbes("there are too many probes");
    probes.cells = readPayload<ProbeCell>(reader, object, "cells", wholeNumber(object, "cellCount"));
    probes.places = readPayload<PackedPlace>(reader, object, "places", count);
    probes.indirect = readPayload<PackedIrradianceSh>(reader, object, "indirect", count);
    if (object.contains("area")) probes.area = readPayload<PackedIrradianceSh>(reader, object, "area", count);
    probes.distances =
        readPayload<decltype(probes.distances)::value_type>(reader, object, "distances", count);
    if (!isConsistent(probes)) refuseProbes("the cells of the probes do not fit them");
    return probes;
}

}  // namespace phat
