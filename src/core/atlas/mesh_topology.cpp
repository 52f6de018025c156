#include "core/atlas/mesh_topology.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/atlas/atlas.h"
#include "core/base/disjoint_sets.h"

namespace phat {
namespace {

// A triangle whose altitude is under this fraction of its longest edge has no usable normal: float positions
// carry 24 bits, so that such an altitude is rounding of the longest edge itself.
constexpr double kMinAltitude = 1e-7;

struct HalfEdge {
    uint32_t low, high;  // welded vertices
    uint32_t triangle;
    uint8_t corner;  // where the edge starts
    bool forward;    // runs from low to high

    bool sameEdge(const HalfEdge& other) const { return low == other.low && high == other.high; }
    bool operator<(const HalfEdge& other) const {
        return std::tie(low, high, triangle, corner) <
               std::tie(other.low, other.high, other.triangle, other.corner);
    }
};

std::vector<uint32_t> weldVertices(const Scene& scene) {
    std::vector<uint32_t> welded(scene.positions.size());
    std::iota(welded.begin(), welded.end(), 0u);
    std::vector<uint32_t> order;
    const auto key = [&](uint32_t v) {
        const glm::vec3& p = scene.positions[v];
        return std::make_tuple(p.x, p.y, p.z);
    };
    for (const Surface& surface : scene.surfaces) {
        order.resize(surface.vertexCount);
        std::iota(order.begin(), order.end(), surface.firstVertex);
        tbb::parallel_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
            return std::tuple_cat(key(a), std::make_tuple(a)) < std::tuple_cat(key(b), std::make_tuple(b));
        });
        for (size_t i = 1; i < order.size(); ++i)
            if (key(order[i]) == key(order[i - 1])) welded[order[i]] = welded[order[i - 1]];
    }
    return welded;
}

void measureFaces(const Scene& scene, MeshTopology& topology) {
    topology.faceNormal.assign(scene.triangles.size(), glm::dvec3(0));
    topology.faceArea.assign(scene.triangles.size(), 0.0);
    for (size_t t = 0; t < scene.triangles.size(); ++t) {
        const glm::uvec3& v = scene.triangles[t];
        const glm::dvec3 a = scene.positions[v[0]], b = scene.positions[v[1]], c = scene.positions[v[2]];
        const glm::dvec3 cross = glm::cross(b - a, c - a);
        const double doubleArea = glm::length(cross);
        const double longest2 =
            std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
        // Negated so that NaN counts as degenerate.
        if (!(doubleArea > kMinAltitude * longest2) || !std::isfinite(doubleArea)) continue;
        topology.faceNormal[t] = cross / doubleArea;
        topology.faceArea[t] = 0.5 * doubleArea;
    }
}

// Pairs the half-edges [first, last) of one edge: opposite directions only, most similar normals first.
void pairHalfEdges(const HalfEdge* first, const HalfEdge* last, MeshTopology& topology) {
    struct Pair {
        double similarity;
        const HalfEdge *a, *b;
    };
    std::vector<Pair> pairs;
    for (const HalfEdge* a = first; a != last; ++a)
        for (const HalfEdge* b = a + 1; b != last; ++b)
            if (a->forward != b->forward && a->triangle != b->triangle)
                pairs.push_back(
                    {glm::dot(topology.faceNormal[a->triangle], topology.faceNormal[b->triangle]), a, b});
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& x, const Pair& y) { return x.similarity > y.similarity; });
    for (const Pair& pair : pairs) {
        uint32_t& acrossA = topology.neighborAcross[pair.a->triangle][pair.a->corner];
        uint32_t& acrossB = topology.neighborAcross[pair.b->triangle][pair.b->corner];
        if (acrossA != kNoNeighbor || acrossB != kNoNeighbor) continue;
        acrossA = pair.b->triangle;
        acrossB = pair.a->triangle;
    }
}

}  // namespace

MeshTopology buildTopology(const Scene& scene) {
    // An edge shared by more triangles than this is a fan of debris; leaving it unpaired keeps the pairing
    // from becoming quadratic.
    constexpr ptrdiff_t kMaxFan = 64;

    MeshTopology topology;
    topology.weldedVertex = weldVertices(scene);
    measureFaces(scene, topology);
    topology.neighborAcross.assign(scene.triangles.size(), {kNoNeighbor, kNoNeighbor, kNoNeighbor});

    std::vector<HalfEdge> halfEdges;
    halfEdges.reserve(3 * scene.triangles.size());
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        if (topology.degenerate(t)) continue;
        for (uint8_t corner = 0; corner < 3; ++corner) {
            const uint32_t from = topology.weldedVertex[scene.triangles[t][corner]];
            const uint32_t to = topology.weldedVertex[scene.triangles[t][(corner + 1) % 3]];
            halfEdges.push_back({std::min(from, to), std::max(from, to), t, corner, from < to});
        }
    }
    tbb::parallel_sort(halfEdges.begin(), halfEdges.end());

    const HalfEdge* const end = halfEdges.data() + halfEdges.size();
    for (const HalfEdge* first = halfEdges.data(); first != end;) {
        const HalfEdge* last = first + 1;
        while (last != end && last->sameEdge(*first)) ++last;
        if (last - first > 1 && last - first <= kMaxFan) pairHalfEdges(first, last, topology);
        first = last;
    }
    return topology;
}

std::vector<uint32_t> connectedComponents(const Scene& scene) {
    DisjointSets vertices(weldVertices(scene));
    for (const glm::uvec3& triangle : scene.triangles)
        for (int corner = 1; corner < 3; ++corner) vertices.unite(triangle[0], triangle[corner]);
    std::vector<uint32_t> number(vertices.size(), ~0u);
    std::vector<uint32_t> components(scene.triangles.size());
    uint32_t count = 0;
    for (size_t t = 0; t < components.size(); ++t) {
        uint32_t& n = number[vertices.find(scene.triangles[t][0])];
        if (n == ~0u) n = count++;
        components[t] = n;
    }
    return components;
}

}  // namespace phat
