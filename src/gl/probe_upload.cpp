#include "gl/probe_upload.h"

#include "gl/textures.h"

namespace phat {
namespace {

std::vector<glm::uvec4> cellTable(const LightProbes& probes) {
    std::vector<glm::uvec4> table;
    for (const ProbeCell& cell : probes.cells) {
        glm::uvec4 words(0);
        for (int corner = 0; corner < 8; ++corner)
            words[corner / 2] |= uint32_t(cell[size_t(corner)]) << 16 * (corner % 2);
        table.push_back(words);
    }
    return table;
}

void addLight(const PackedIrradianceSh& packed, uint32_t last, std::vector<glm::uvec4>& table) {
    table.emplace_back(packed[0], packed[1], packed[2], packed[3]);
    table.emplace_back(packed[4], packed[5], packed[6], last);
}

std::vector<glm::uvec4> lightTable(const LightProbes& probes) {
    std::vector<glm::uvec4> table;
    for (size_t i = 0; i < probes.count(); ++i) {
        addLight(probes.indirect[i], probes.places[i], table);
        if (!probes.area.empty()) addLight(probes.area[i], 0, table);
    }
    return table;
}

// The corners of each square of the octahedron in a word, so that a shader reads them at once. The four
// quarters are mirrored to the first, as probeVisibility() does it.
std::vector<glm::uvec4> distanceTable(const LightProbes& probes) {
    constexpr int kSide = kDistanceIntervals, kWords = 4 * kSide * kSide;
    std::vector<glm::uvec4> table((probes.count() * kWords + 3) / 4, glm::uvec4(0));
    for (size_t i = 0; i < probes.count() * kWords; ++i) {
        const auto& code = probes.distances[i / kWords];
        const int within = int(i % kWords), quarter = within / (kSide * kSide);
        const glm::ivec2 corner(within % kSide, within / kSide % kSide);
        const glm::ivec2 mirror(quarter % 2 ? -1 : 1, quarter / 2 ? -1 : 1);
        for (int c = 0; c < 4; ++c) {
            const glm::ivec2 node = kSide + mirror * (corner + glm::ivec2(c % 2, c / 2));
            table[i / 4][int(i % 4)] |= uint32_t(code[size_t(node.y * kDistanceNodes + node.x)]) << 8 * c;
        }
    }
    return table;
}

GlTexture tableOf(std::vector<glm::uvec4> values) {
    if (values.empty()) values.emplace_back(0);
    return createTable(std::span<const glm::uvec4>(values));
}

}  // namespace

GpuProbes uploadProbes(const LightProbes& probes) {
    GpuProbes gpu;
    gpu.light = tableOf(lightTable(probes));
    gpu.distances = tableOf(distanceTable(probes));
    gpu.texelsPerProbe = probes.area.empty() ? 2 : 4;
    if (probes.cells.empty()) {
        gpu.cells = tableOf({glm::uvec4(~0u)});  // kNoProbe at each corner
        return gpu;
    }
    gpu.cells = tableOf(cellTable(probes));
    gpu.lowWorld = probes.lowWorld;
    gpu.cellMeters = probes.cellMeters;
    gpu.gridSize = glm::vec3(probes.gridSize);
    return gpu;
}

void bindProbes(const ShaderProgram& program, const GpuProbes& probes, int firstUnit) {
    program.bind("probeCells", firstUnit, probes.cells.name());
    program.bind("probeLight", firstUnit + 1, probes.light.name());
    program.bind("probeDistances", firstUnit + 2, probes.distances.name());
    program.set("probeLow", probes.lowWorld);
    program.set("probeCellMeters", probes.cellMeters);
    program.set("probeGrid", probes.gridSize);
    program.set("probeTexels", probes.texelsPerProbe);
}

}  // namespace phat
