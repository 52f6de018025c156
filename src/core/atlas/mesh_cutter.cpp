#include "core/atlas/mesh_cutter.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

namespace phat {

// A line on the plane of a triangle, from t = 0 to `length`.
struct MeshCutter::Line {
    glm::dvec3 from, direction, across;  // `across` points to the left of `direction`
    double length;

    double along(glm::dvec3 point) const { return glm::dot(point - from, direction); }
};

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

// `t` from a to b. Every triangle at the edge becomes two.
void MeshCutter::splitEdge(uint32_t a, uint32_t b, double t) {
    const Edge edge = edgeOf(a, b);
    const std::vector<uint32_t> users = std::move(edges_[edge]);
    edges_.erase(edge);
    const glm::dvec3 position = glm::mix(positions_[welded_[a]], positions_[welded_[b]], t);
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middleOf;  // by the edge's own vertices
    uint32_t welded = ~0u;
    for (const uint32_t user : users) {
        const glm::uvec3 corners = triangles_[user];
        int i = 0;
        while (edgeOf(corners[i], corners[(i + 1) % 3]) != edge) ++i;
        const uint32_t from = corners[i], to = corners[(i + 1) % 3], apex = corners[(i + 2) % 3];
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
    }
    if (const auto marked = sections_.find(edge); marked != sections_.end() && welded != ~0u) {
        const std::vector<uint32_t> numbers = marked->second;
        sections_.erase(marked);
        sections_[edgeOf(a, welded)] = numbers;
        sections_[edgeOf(welded, b)] = numbers;
    }
}

// Joins a point inside a triangle to its corners.
void MeshCutter::splitTriangle(uint32_t triangle, glm::dvec3 point) {
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
    for (int i = 1; i < 3; ++i) std::erase(edges_[edgeOf(corners[i], corners[(i + 1) % 3])], triangle);
    setTriangle(triangle, {corners[0], corners[1], middle});
    addTriangle({corners[1], corners[2], middle}, origin_[triangle]);
    addTriangle({corners[2], corners[0], middle}, origin_[triangle]);
}

// Makes a point of a triangle of the scene a vertex, unless there is one.
void MeshCutter::insertPoint(uint32_t sceneTriangle, glm::dvec3 point) {
    const glm::dvec3 normal = topology_.faceNormal[sceneTriangle];
    uint32_t best = ~0u;
    double bestDepth = -1e300;
    double depths[3], bestDepths[3] = {};
    for (const uint32_t piece : piecesNear(sceneTriangle, point, point)) {
        const glm::uvec3& corners = triangles_[piece];
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 a = positions_[corners[i]], edge = positions_[corners[(i + 1) % 3]] - a;
            const double length = glm::length(edge);
            depths[i] = length > 0 ? glm::dot(glm::cross(normal, edge), point - a) / length : -1e300;
            if (glm::distance(point, a) <= tolerance_) return;
        }
        const double depth = std::min({depths[0], depths[1], depths[2]});
        if (depth <= bestDepth) continue;
        best = piece;
        bestDepth = depth;
        std::copy_n(depths, 3, bestDepths);
    }
    if (best == ~0u) return;
    const glm::uvec3 corners = triangles_[best];
    for (int i = 0; i < 3; ++i) {
        if (bestDepths[i] > tolerance_) continue;
        const glm::dvec3 a = positions_[corners[i]], edge = positions_[corners[(i + 1) % 3]] - a;
        const double t = glm::dot(point - a, edge) / glm::dot(edge, edge);
        if (t > 0 && t < 1) splitEdge(corners[i], corners[(i + 1) % 3], t);
        return;
    }
    splitTriangle(best, point);
}

void MeshCutter::addToGrid(TriangleGrid& grid, uint32_t piece) const {
    const glm::uvec3& v = triangles_[piece];
    grid.add(piece, {positions_[v[0]], positions_[v[1]], positions_[v[2]]});
}

// The pieces of a triangle of the scene that a segment may touch, and others.
std::vector<uint32_t> MeshCutter::piecesNear(uint32_t sceneTriangle, glm::dvec3 from, glm::dvec3 to) {
    constexpr size_t kMinPieces = 64;
    const std::vector<uint32_t>& all = pieces_[sceneTriangle];
    if (all.size() < kMinPieces) return all;
    auto found = grids_.find(sceneTriangle);
    if (found == grids_.end()) {
        const glm::uvec3& v = scene_.triangles[sceneTriangle];
        const glm::dvec3 corners[] = {scene_.positions[v[0]], scene_.positions[v[1]], scene_.positions[v[2]]};
        found = grids_.try_emplace(sceneTriangle, corners, topology_.faceNormal[sceneTriangle]).first;
        for (const uint32_t piece : all) addToGrid(found->second, piece);
    }
    return found->second.near(from, to, 2 * tolerance_);
}

double MeshCutter::toLine(const Line& line, uint32_t vertex) const {
    const double distance = glm::dot(positions_[vertex] - line.from, line.across);
    return std::abs(distance) <= tolerance_ ? 0 : distance;
}

// Splits one edge of the triangle where the line crosses it. Returns whether there was one.
bool MeshCutter::splitAcross(const Line& line, uint32_t triangle) {
    const glm::uvec3 corners = triangles_[triangle];
    double distance[3];
    for (int i = 0; i < 3; ++i) distance[i] = toLine(line, corners[i]);
    double low = 1e300, high = -1e300;
    int crossed = -1;
    double crossedAt = 0;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const glm::dvec3 a = positions_[corners[i]], b = positions_[corners[j]];
        double t = 0;
        if (distance[i] * distance[j] < 0) {
            t = distance[i] / (distance[i] - distance[j]);
            crossed = i;
            crossedAt = t;
        } else if (distance[i] != 0) {
            continue;
        }
        const double along = line.along(glm::mix(a, b, t));
        low = std::min(low, along);
        high = std::max(high, along);
    }
    if (crossed < 0) return false;
    if (high <= tolerance_ || low >= line.length - tolerance_) return false;
    splitEdge(corners[crossed], corners[(crossed + 1) % 3], crossedAt);
    return true;
}

void MeshCutter::cut(const WallSection& section, uint32_t number) {
    Line line;
    line.from = section.from;
    line.length = glm::distance(section.from, section.to);
    if (!(line.length > 2 * tolerance_)) return;
    line.direction = (section.to - section.from) / line.length;
    line.across = glm::cross(topology_.faceNormal[section.triangle], line.direction);

    insertPoint(section.triangle, section.from);
    insertPoint(section.triangle, section.to);
    std::vector<uint32_t> pieces = piecesNear(section.triangle, section.from, section.to);
    for (size_t i = 0; i < pieces.size();) {
        // The triangle keeps one of the two parts, which the line may still cross; the other one is new.
        const size_t before = pieces_[section.triangle].size();
        if (!splitAcross(line, pieces[i])) ++i;
        const std::vector<uint32_t>& all = pieces_[section.triangle];
        pieces.insert(pieces.end(), all.begin() + std::ptrdiff_t(before), all.end());
    }
    for (const uint32_t piece : pieces) {
        const glm::uvec3& corners = triangles_[piece];
        for (int i = 0; i < 3; ++i) {
            const uint32_t a = corners[i], b = corners[(i + 1) % 3];
            if (toLine(line, a) != 0 || toLine(line, b) != 0) continue;
            const double middle = line.along(0.5 * (positions_[a] + positions_[b]));
            if (middle < -tolerance_ || middle > line.length + tolerance_) continue;
            std::vector<uint32_t>& numbers = sections_[edgeOf(a, b)];
            if (numbers.empty() || numbers.back() != number) numbers.push_back(number);
        }
    }
}

}  // namespace phat
