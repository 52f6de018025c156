#include "core/atlas/dividing_sections.h"

#include <algorithm>

#include "core/atlas/wall_regions.h"
#include "core/base/disjoint_sets.h"

namespace phat {
namespace {

constexpr double kOnBorderTexels = 0.01;
constexpr size_t kMaxSections = 1000;
constexpr double kMinTexelsPerSection = 16;

bool isBorder(const MeshTopology& topology, uint32_t triangle, int edge) {
    const uint32_t other = topology.neighborAcross[triangle][edge];
    return other == kNoNeighbor || isFold(topology.faceNormal[triangle], topology.faceNormal[other]);
}

// Per triangle: the first of its face.
DisjointSets facesOf(const MeshTopology& topology) {
    DisjointSets faces(topology.neighborAcross.size());
    for (uint32_t t = 0; t < topology.neighborAcross.size(); ++t)
        for (int i = 0; i < 3; ++i)
            if (!isBorder(topology, t, i)) faces.unite(t, topology.neighborAcross[t][i]);
    return faces;
}

double distanceToLine(glm::dvec3 point, glm::dvec3 from, glm::dvec3 to) {
    return glm::length(glm::cross(point - from, glm::normalize(to - from)));
}

bool isOnBorder(const WallSection& section, const Scene& scene, const MeshTopology& topology,
                double tolerance) {
    const glm::uvec3& v = scene.triangles[section.triangle];
    for (int i = 0; i < 3; ++i) {
        if (!isBorder(topology, section.triangle, i)) continue;
        const glm::dvec3 a = scene.positions[v[i]], b = scene.positions[v[(i + 1) % 3]];
        if (distanceToLine(section.from, a, b) <= tolerance && distanceToLine(section.to, a, b) <= tolerance)
            return true;
    }
    return false;
}

}  // namespace

std::vector<WallSection> dividingSections(std::vector<WallSection> sections, const Scene& scene,
                                          const MeshTopology& topology, double texelSizeMeters) {
    std::erase_if(sections, [&](const WallSection& section) {
        return isOnBorder(section, scene, topology, kOnBorderTexels * texelSizeMeters);
    });
    DisjointSets faces = facesOf(topology);
    std::vector<double> texels(scene.triangles.size(), 0);
    std::vector<size_t> count(scene.triangles.size(), 0);
    for (uint32_t t = 0; t < scene.triangles.size(); ++t)
        texels[faces.find(t)] += topology.faceArea[t] / (texelSizeMeters * texelSizeMeters);
    for (const WallSection& section : sections) ++count[faces.find(section.triangle)];
    std::erase_if(sections, [&](const WallSection& section) {
        const uint32_t face = faces.find(section.triangle);
        return count[face] > kMaxSections && texels[face] < kMinTexelsPerSection * double(count[face]);
    });
    return sections;
}

}  // namespace phat
