#include "core/atlas/mesh_cutter.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

namespace phat {

namespace {

bool isBefore(glm::vec3 a, glm::vec3 b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

// The first vertex at each one's position, of whatever surface.
std::vector<uint32_t> weldAll(const std::vector<glm::vec3>& positions) {
    std::vector<uint32_t> order(positions.size()), welded(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    tbb::parallel_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        if (positions[a] != positions[b]) return isBefore(positions[a], positions[b]);
        return a < b;
    });
    for (size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && positions[order[i]] == positions[order[i - 1]];
        welded[order[i]] = same ? welded[order[i - 1]] : order[i];
    }
    return welded;
}

}  // namespace

MeshCutter::MeshCutter(const Scene& scene, const MeshTopology& topology, double toleranceMeters)
    : scene_(scene),
      topology_(topology),
      tolerance_(toleranceMeters),
      positions_(scene.positions.begin(), scene.positions.end()),
      welded_(weldAll(scene.positions)),
      pieces_(scene.triangles.size()) {
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) addTriangle(scene.triangles[t], t);
}

MeshCutter::Edge MeshCutter::edgeOf(uint32_t a, uint32_t b) const {
    const uint64_t x = welded_[a], y = welded_[b];
    return std::min(x, y) << 32 | std::max(x, y);
}

const std::vector<uint32_t>* MeshCutter::sectionsOf(Edge edge) const {
    const auto found = sections_.find(edge);
    return found == sections_.end() ? nullptr : &found->second;
}

uint32_t MeshCutter::addVertex(const CutVertex& vertex, glm::dvec3 position, uint32_t welded) {
    added_.push_back(vertex);
    positions_.push_back(glm::dvec3(glm::vec3(position)));  // as it will be stored
    welded_.push_back(welded);
    return uint32_t(positions_.size() - 1);
}

uint32_t MeshCutter::addTriangle(glm::uvec3 corners, uint32_t origin) {
    const uint32_t triangle = uint32_t(triangles_.size());
    triangles_.emplace_back(0);
    origin_.push_back(origin);
    pieces_[origin].push_back(triangle);
    setTriangle(triangle, corners);
    if (const auto grid = grids_.find(origin); grid != grids_.end()) addToGrid(grid->second, triangle);
    return triangle;
}

// Registers the edges; those that the triangle had before must be gone already.
void MeshCutter::setTriangle(uint32_t triangle, glm::uvec3 corners) {
    triangles_[triangle] = corners;
    if (topology_.degenerate(origin_[triangle])) return;
    for (int i = 0; i < 3; ++i) {
        std::vector<uint32_t>& users = edges_[edgeOf(corners[i], corners[(i + 1) % 3])];
        if (std::find(users.begin(), users.end(), triangle) == users.end()) users.push_back(triangle);
    }
}

std::array<MeshCutter::Edge, 3> MeshCutter::edgesOf(uint32_t triangle) const {
    const glm::uvec3& v = triangles_[triangle];
    return {edgeOf(v[0], v[1]), edgeOf(v[1], v[2]), edgeOf(v[2], v[0])};
}

// The corner that is not on an edge of the triangle.
int MeshCutter::cornerAcross(uint32_t triangle, Edge edge) const {
    const std::array<Edge, 3> edges = edgesOf(triangle);
    return int((std::find(edges.begin(), edges.end(), edge) - edges.begin() + 2) % 3);
}

uint32_t MeshCutter::vertexAcross(uint32_t triangle, Edge edge) const {
    return welded_[triangles_[triangle][cornerAcross(triangle, edge)]];
}

// `t` from a to b. Every triangle at the edge becomes two.
uint32_t MeshCutter::splitEdge(uint32_t a, uint32_t b, double t) {
    const Edge edge = edgeOf(a, b);
    const std::vector<uint32_t> users = std::move(edges_[edge]);
    edges_.erase(edge);
    const glm::dvec3 position = glm::mix(positions_[welded_[a]], positions_[welded_[b]], t);
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middleOf;  // by the edge's own vertices
    std::vector<Edge> open;
    uint32_t welded = ~0u;
    for (const uint32_t user : users) {
        const glm::uvec3 corners = triangles_[user];
        const int across = cornerAcross(user, edge);
        const uint32_t from = corners[(across + 1) % 3], to = corners[(across + 2) % 3],
                       apex = corners[across];
        const bool forward = welded_[from] == welded_[a];
        const auto key = forward ? std::make_pair(from, to) : std::make_pair(to, from);
        const auto [found, isNew] = middleOf.try_emplace(key, 0);
        if (isNew) {
            found->second = addVertex({{key.first, key.second, key.first}, {1 - t, t, 0}}, position,
                                      welded == ~0u ? uint32_t(positions_.size()) : welded);
            welded = welded_[found->second];
        }
        const uint32_t middle = found->second;
        std::erase(edges_[edgeOf(to, apex)], user);
        setTriangle(user, {from, middle, apex});
        addTriangle({middle, to, apex}, origin_[user]);
        open.insert(open.end(), {edgeOf(from, apex), edgeOf(to, apex)});
    }
    if (const auto marked = sections_.find(edge); marked != sections_.end() && welded != ~0u) {
        const std::vector<uint32_t> numbers = marked->second;
        sections_.erase(marked);
        sections_[edgeOf(a, welded)] = numbers;
        sections_[edgeOf(welded, b)] = numbers;
    }
    makeDelaunay(std::move(open));
    return welded;
}

// Joins a point inside a triangle to its corners.
uint32_t MeshCutter::splitTriangle(uint32_t triangle, glm::dvec3 point) {
    const glm::uvec3 corners = triangles_[triangle];
    const glm::dvec3 normal = topology_.faceNormal[origin_[triangle]];
    CutVertex vertex;
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 a = positions_[corners[(i + 1) % 3]], b = positions_[corners[(i + 2) % 3]];
        vertex.from[i] = corners[i];
        vertex.weight[i] = std::max(glm::dot(normal, glm::cross(a - point, b - point)), 0.0);
        sum += vertex.weight[i];
    }
    for (double& weight : vertex.weight) weight /= sum;
    const uint32_t middle = addVertex(vertex, point, uint32_t(positions_.size()));
    const std::array<Edge, 3> around = edgesOf(triangle);
    for (int i = 1; i < 3; ++i) std::erase(edges_[edgeOf(corners[i], corners[(i + 1) % 3])], triangle);
    setTriangle(triangle, {corners[0], corners[1], middle});
    addTriangle({corners[1], corners[2], middle}, origin_[triangle]);
    addTriangle({corners[2], corners[0], middle}, origin_[triangle]);
    makeDelaunay({around.begin(), around.end()});
    return middle;
}

// Whether two triangles of one triangle of the scene meet in an edge, on no section, and form a convex
// quadrilateral.
bool MeshCutter::canFlip(Edge edge) const {
    const auto found = edges_.find(edge);
    if (found == edges_.end() || found->second.size() != 2 || sections_.contains(edge)) return false;
    const uint32_t first = found->second[0], second = found->second[1];
    if (origin_[first] != origin_[second]) return false;
    const glm::dvec3 a = positions_[uint32_t(edge >> 32)], b = positions_[uint32_t(edge)],
                     c = positions_[vertexAcross(first, edge)], d = positions_[vertexAcross(second, edge)];
    const glm::dvec3 normal = topology_.faceNormal[origin_[first]];
    const double length = glm::distance(c, d);
    const double left = glm::dot(normal, glm::cross(d - c, a - c)),
                 right = glm::dot(normal, glm::cross(d - c, b - c));
    return left * right < 0 && std::min(std::abs(left), std::abs(right)) > tolerance_ * length;
}

// The other diagonal of the two triangles at an edge becomes theirs. pre: canFlip(edge)
MeshCutter::Edge MeshCutter::flip(Edge edge) {
    const uint32_t first = edges_[edge][0], second = edges_[edge][1];
    const int i = cornerAcross(first, edge), j = cornerAcross(second, edge);
    const uint32_t c = triangles_[first][i], a = triangles_[first][(i + 1) % 3],
                   b = triangles_[first][(i + 2) % 3], d = triangles_[second][j];
    edges_.erase(edge);
    std::erase(edges_[edgeOf(b, c)], first);
    std::erase(edges_[edgeOf(a, d)], second);
    setTriangle(first, {a, d, c});
    setTriangle(second, {d, b, c});
    if (const auto grid = grids_.find(origin_[first]); grid != grids_.end()) {
        addToGrid(grid->second, first);
        addToGrid(grid->second, second);
    }
    return edgeOf(c, d);
}

// Whether the angles across an edge are at most 180 degrees together. pre: canFlip(edge)
bool MeshCutter::isDelaunay(Edge edge) const {
    const std::vector<uint32_t>& users = edges_.at(edge);
    const glm::dvec3 a = positions_[uint32_t(edge >> 32)], b = positions_[uint32_t(edge)];
    double sine[2], cosine[2];
    for (int i = 0; i < 2; ++i) {
        const glm::dvec3 apex = positions_[vertexAcross(users[size_t(i)], edge)];
        sine[i] = glm::length(glm::cross(a - apex, b - apex));
        cosine[i] = glm::dot(a - apex, b - apex);
    }
    constexpr double kRounding = 1e-6;
    const double scale = (sine[0] + std::abs(cosine[0])) * (sine[1] + std::abs(cosine[1]));
    return sine[0] * cosine[1] + cosine[0] * sine[1] >= -kRounding * scale;
}

// Flips edges until all of `open` and those that change with them are Delaunay. source: Lawson 1977,
// "Software for C1 Surface Interpolation".
void MeshCutter::makeDelaunay(std::vector<Edge> open) {
    while (!open.empty()) {
        const Edge edge = open.back();
        open.pop_back();
        if (!canFlip(edge) || isDelaunay(edge)) continue;
        const Edge other = flip(edge);
        for (const uint32_t triangle : edges_.at(other))
            for (const Edge around : edgesOf(triangle))
                if (around != other) open.push_back(around);
    }
}

}  // namespace phat
