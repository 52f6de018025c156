// Lines become edges of the mesh: the part of MeshCutter that finds and follows them.

#include <algorithm>
#include <cmath>
#include <map>

#include "core/atlas/mesh_cutter.h"

namespace phat {
namespace {

constexpr uint32_t kNoVertex = ~0u;

}  // namespace

// A line on the plane of a triangle, from t = 0 to `length`.
struct MeshCutter::Line {
    glm::dvec3 from, direction, across;  // `across` points to the left of `direction`
    double length;

    double along(glm::dvec3 point) const { return glm::dot(point - from, direction); }
    double left(glm::dvec3 point) const { return glm::dot(point - from, across); }
};

struct MeshCutter::Way {
    uint32_t end;                     // kNoVertex: none
    std::vector<uint32_t> triangles;  // from the first to the last; none where the way is an edge
    std::vector<Crossed> crossed;     // the edges between them
};

MeshCutter::Line MeshCutter::lineBetween(uint32_t sceneTriangle, uint32_t from, uint32_t to) const {
    Line line;
    line.from = positions_[from];
    line.length = glm::distance(positions_[from], positions_[to]);
    line.direction = (positions_[to] - positions_[from]) / line.length;
    line.across = glm::cross(topology_.faceNormal[sceneTriangle], line.direction);
    return line;
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

// The vertex at a point of a triangle of the scene; kNoVertex: the point is outside.
uint32_t MeshCutter::insertPoint(uint32_t sceneTriangle, glm::dvec3 point) {
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
            if (glm::distance(point, a) <= tolerance_) return welded_[corners[i]];
        }
        const double depth = std::min({depths[0], depths[1], depths[2]});
        if (depth <= bestDepth) continue;
        best = piece;
        bestDepth = depth;
        std::copy_n(depths, 3, bestDepths);
    }
    if (best == ~0u) return kNoVertex;
    const glm::uvec3 corners = triangles_[best];
    for (int i = 0; i < 3; ++i) {
        if (bestDepths[i] > tolerance_) continue;
        const glm::dvec3 a = positions_[corners[i]], edge = positions_[corners[(i + 1) % 3]] - a;
        const double t = glm::dot(point - a, edge) / glm::dot(edge, edge);
        return t > 0 && t < 1 ? splitEdge(corners[i], corners[(i + 1) % 3], t) : kNoVertex;
    }
    return splitTriangle(best, point);
}

// Walks from one vertex straight toward another, to the first vertex on the way, at the latest `to`.
MeshCutter::Way MeshCutter::follow(uint32_t sceneTriangle, uint32_t from, uint32_t to) {
    const Line line = lineBetween(sceneTriangle, from, to);
    const auto isOnTheWay = [&](uint32_t vertex) {
        if (vertex == to) return true;
        const double along = line.along(positions_[vertex]);
        return along > tolerance_ && along < line.length &&
               std::abs(line.left(positions_[vertex])) <= tolerance_;
    };
    Way way{kNoVertex, {}, {}};
    for (const uint32_t piece : piecesNear(sceneTriangle, line.from, line.from)) {
        const glm::uvec3& corners = triangles_[piece];
        int i = 0;
        while (i < 3 && welded_[corners[i]] != from) ++i;
        if (i == 3) continue;
        const uint32_t right = welded_[corners[(i + 1) % 3]], left = welded_[corners[(i + 2) % 3]];
        for (const uint32_t vertex : {left, right})
            if (isOnTheWay(vertex)) return {vertex, {}, {}};
        if (line.left(positions_[right]) >= 0 || line.left(positions_[left]) <= 0) continue;
        way.crossed.push_back({left, right});
        way.triangles.push_back(piece);
    }
    if (way.crossed.size() != 1) return {kNoVertex, {}, {}};
    while (true) {
        const auto [left, right] = way.crossed.back();
        const Edge edge = edgeOf(left, right);
        const std::vector<uint32_t>& users = edges_.at(edge);
        const auto next = std::find_if(users.begin(), users.end(), [&](uint32_t user) {
            return user != way.triangles.back() && origin_[user] == sceneTriangle;
        });
        if (next == users.end()) return {kNoVertex, {}, {}};
        way.triangles.push_back(*next);
        const uint32_t vertex = vertexAcross(*next, edge);
        if (isOnTheWay(vertex)) {
            way.end = vertex;
            return way;
        }
        const bool isLeft = line.left(positions_[vertex]) > 0;
        way.crossed.push_back(isLeft ? Crossed{vertex, right} : Crossed{left, vertex});
    }
}

// The polygons on both sides of a line that crosses triangles are triangulated anew, with the line as their
// common edge. source: Anglada 1997, "An Improved Incremental Algorithm for Constructing Restricted Delaunay
// Triangulations".
void MeshCutter::retriangulate(uint32_t from, const Way& way) {
    std::map<uint32_t, uint32_t> ownVertex;
    for (const uint32_t triangle : way.triangles) {
        for (int i = 0; i < 3; ++i) ownVertex[welded_[triangles_[triangle][i]]] = triangles_[triangle][i];
        for (const Edge edge : edgesOf(triangle)) std::erase(edges_[edge], triangle);
    }
    std::vector<uint32_t> left{ownVertex[from]}, right{ownVertex[way.end]};
    const auto add = [&](std::vector<uint32_t>& chain, uint32_t vertex) {
        if (chain.back() != ownVertex[vertex]) chain.push_back(ownVertex[vertex]);
    };
    for (const Crossed& edge : way.crossed) add(left, edge.left);
    for (size_t i = way.crossed.size(); i-- > 0;) add(right, way.crossed[i].right);
    left.push_back(ownVertex[way.end]);
    right.push_back(ownVertex[from]);

    std::vector<glm::uvec3> corners;
    triangulate(left, corners);
    triangulate(right, corners);
    const auto grid = grids_.find(origin_[way.triangles[0]]);
    for (size_t i = 0; i < corners.size(); ++i) {
        setTriangle(way.triangles[i], corners[i]);
        if (grid != grids_.end()) addToGrid(grid->second, way.triangles[i]);
    }
}

// Delaunay triangles of a polygon on the left of the line from its first vertex to its last: the third
// vertex of a triangle is the one that sees the other two under the widest angle.
void MeshCutter::triangulate(std::span<const uint32_t> polygon, std::vector<glm::uvec3>& corners) const {
    if (polygon.size() < 3) return;
    const glm::dvec3 a = positions_[polygon.front()], b = positions_[polygon.back()];
    size_t best = 1;
    double bestCosine = 2;
    for (size_t i = 1; i + 1 < polygon.size(); ++i) {
        const glm::dvec3 c = positions_[polygon[i]];
        const double cosine = glm::dot(glm::normalize(a - c), glm::normalize(b - c));
        if (cosine >= bestCosine) continue;
        bestCosine = cosine;
        best = i;
    }
    corners.push_back({polygon.front(), polygon.back(), polygon[best]});
    triangulate(polygon.first(best + 1), corners);
    triangulate(polygon.subspan(best), corners);
}

// Splits the sections that a line crosses, where it does.
std::vector<uint32_t> MeshCutter::splitSections(const Line& line, const std::vector<Crossed>& crossed) {
    std::vector<uint32_t> middles;
    for (const Crossed& edge : crossed) {
        if (!sections_.contains(edgeOf(edge.left, edge.right))) continue;
        const double left = line.left(positions_[edge.left]), right = line.left(positions_[edge.right]);
        middles.push_back(splitEdge(edge.left, edge.right, left / (left - right)));
    }
    return middles;
}

void MeshCutter::cut(const WallSection& section, uint32_t number) {
    if (!(glm::distance(section.from, section.to) > 2 * tolerance_)) return;
    std::vector<std::pair<uint32_t, uint32_t>> open{
        {insertPoint(section.triangle, section.from), insertPoint(section.triangle, section.to)}};
    if (open[0].first == kNoVertex || open[0].second == kNoVertex) return;
    while (!open.empty()) {
        const auto [from, to] = open.back();
        open.pop_back();
        if (from == to) continue;
        const Way way = follow(section.triangle, from, to);
        if (way.end == kNoVertex) continue;
        if (way.end != to) open.push_back({way.end, to});
        const std::vector<uint32_t> middles =
            splitSections(lineBetween(section.triangle, from, way.end), way.crossed);
        if (!middles.empty()) {
            uint32_t after = way.end;
            for (size_t i = middles.size(); i-- > 0; after = middles[i]) open.push_back({middles[i], after});
            open.push_back({from, after});
            continue;
        }
        if (!way.crossed.empty()) retriangulate(from, way);
        std::vector<uint32_t>& numbers = sections_[edgeOf(from, way.end)];
        if (numbers.empty() || numbers.back() != number) numbers.push_back(number);
    }
}

}  // namespace phat
