#include <algorithm>
#include <cmath>

#include "core/atlas/unwrap_flatten.h"
#include "core/base/math.h"

namespace phat {
namespace {

double crossOf(glm::dvec2 a, glm::dvec2 b) {
    return a.x * b.y - a.y * b.x;
}

// The outline's edges, listed by the cells of a uniform grid (for crossings) and by its rows (for winding).
struct OutlineGrid {
    glm::dvec2 low{1e300}, high{-1e300};
    int columns = 1, rows = 1;
    std::vector<std::vector<uint32_t>> cells, rowEdges;

    glm::ivec2 cellOf(glm::dvec2 p) const {
        const glm::dvec2 at = (p - low) / glm::max(high - low, glm::dvec2(1e-300));
        return {std::clamp(int(at.x * columns), 0, columns - 1), std::clamp(int(at.y * rows), 0, rows - 1)};
    }
};

OutlineGrid buildGrid(const ChartMesh& mesh, const std::vector<glm::dvec2>& uv) {
    OutlineGrid grid;
    for (const glm::dvec2& p : uv) {
        grid.low = glm::min(grid.low, p);
        grid.high = glm::max(grid.high, p);
    }
    // About as many rows and columns as edges along a side: the outline of a compact chart then leaves O(1)
    // edges in a cell.
    grid.columns = grid.rows = std::clamp(int(mesh.boundary.size() / 4), 1, 1024);
    grid.cells.resize(size_t(grid.columns) * grid.rows);
    grid.rowEdges.resize(grid.rows);
    for (uint32_t e = 0; e < mesh.boundary.size(); ++e) {
        const glm::ivec2 a = grid.cellOf(uv[mesh.boundary[e].from]), b = grid.cellOf(uv[mesh.boundary[e].to]);
        for (int y = std::min(a.y, b.y); y <= std::max(a.y, b.y); ++y) {
            grid.rowEdges[y].push_back(e);
            for (int x = std::min(a.x, b.x); x <= std::max(a.x, b.x); ++x)
                grid.cells[size_t(y) * grid.columns + x].push_back(e);
        }
    }
    return grid;
}

// Whether both segments run through each other by more than `tolerance`.
bool crosses(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d, double tolerance) {
    const glm::dvec2 ab = b - a, cd = d - c;
    const double lengthAb = glm::length(ab), lengthCd = glm::length(cd);
    const double sideC = crossOf(ab, c - a), sideD = crossOf(ab, d - a);
    const double sideA = crossOf(cd, a - c), sideB = crossOf(cd, b - c);
    const auto opposite = [](double x, double y, double eps) {
        return (x > eps && y < -eps) || (x < -eps && y > eps);
    };
    return opposite(sideC, sideD, tolerance * lengthAb) && opposite(sideA, sideB, tolerance * lengthCd);
}

// How often the outline runs around `p`; edges left of p do not count.
int windingAround(const ChartMesh& mesh, const std::vector<glm::dvec2>& uv, const OutlineGrid& grid,
                  glm::dvec2 p) {
    int winding = 0;
    for (const uint32_t e : grid.rowEdges[grid.cellOf(p).y]) {
        const glm::dvec2 a = uv[mesh.boundary[e].from], b = uv[mesh.boundary[e].to];
        if (a.y <= p.y && b.y > p.y && crossOf(b - a, p - a) > 0) ++winding;
        if (a.y > p.y && b.y <= p.y && crossOf(b - a, p - a) < 0) --winding;
    }
    return winding;
}

// Angles around inner vertices must add up to one turn.
bool anyVertexWoundTwice(const ChartMesh& mesh, const std::vector<glm::dvec2>& uv) {
    std::vector<double> angle(uv.size(), 0.0);
    for (const auto& corners : mesh.corners) {
        for (int corner = 0; corner < 3; ++corner) {
            const glm::dvec2 p = uv[corners[corner]];
            const glm::dvec2 a = uv[corners[(corner + 1) % 3]] - p, b = uv[corners[(corner + 2) % 3]] - p;
            angle[corners[corner]] += std::atan2(crossOf(a, b), glm::dot(a, b));
        }
    }
    return std::any_of(angle.begin(), angle.end(), [](double sum) { return sum > 2 * double(kPi) + 1e-3; });
}

}  // namespace

bool isInjective(const ChartMesh& mesh, const std::vector<glm::dvec2>& uv) {
    for (const auto& [a, b, c] : mesh.corners)
        if (!(crossOf(uv[b] - uv[a], uv[c] - uv[a]) > 0)) return false;
    if (mesh.triangles.size() == 1) return true;
    if (anyVertexWoundTwice(mesh, uv)) return false;

    const OutlineGrid grid = buildGrid(mesh, uv);
    // Far under a texel of the largest atlas; touching outlines are not overlaps.
    const double tolerance = 1e-7 * glm::length(grid.high - grid.low);
    for (const std::vector<uint32_t>& cell : grid.cells) {
        for (size_t i = 0; i < cell.size(); ++i) {
            const ChartMesh::Edge& e = mesh.boundary[cell[i]];
            for (size_t j = i + 1; j < cell.size(); ++j) {
                const ChartMesh::Edge& f = mesh.boundary[cell[j]];
                if (crosses(uv[e.from], uv[e.to], uv[f.from], uv[f.to], tolerance)) return false;
            }
        }
    }
    for (const ChartMesh::Edge& e : mesh.boundary) {
        const auto& [a, b, c] = mesh.corners[e.triangle];
        if (windingAround(mesh, uv, grid, (uv[a] + uv[b] + uv[c]) / 3.0) != 1) return false;
    }
    return true;
}

std::vector<glm::dvec2> convexHull(std::vector<glm::dvec2> sorted) {
    std::sort(sorted.begin(), sorted.end(),
              [](glm::dvec2 a, glm::dvec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    std::vector<glm::dvec2> hull(2 * sorted.size());
    size_t count = 0;
    const auto append = [&](glm::dvec2 p, size_t keep) {
        while (count >= keep && crossOf(hull[count - 1] - hull[count - 2], p - hull[count - 2]) <= 0) --count;
        hull[count++] = p;
    };
    for (const glm::dvec2& p : sorted) append(p, 2);
    const size_t keep = count + 1;
    for (size_t i = sorted.size() - 1; i-- > 0;) append(sorted[i], keep);
    hull.resize(count);
    return hull;
}

glm::dvec2 alignToBox(std::vector<glm::dvec2>& uv) {
    const std::vector<glm::dvec2> hull = convexHull(uv);
    // The smallest box has a side along a hull edge. source: Freeman and Shapira 1975. The hull's corner that
    // is farthest along each axis only moves forward with the edge, but hulls are small.
    double bestArea = INFINITY;
    glm::dvec2 axis(1, 0);
    for (size_t i = 0; i + 1 < hull.size(); ++i) {
        const glm::dvec2 edge = hull[i + 1] - hull[i];
        const double length = glm::length(edge);
        if (!(length > 0)) continue;
        const glm::dvec2 x = edge / length;
        glm::dvec2 low(1e300), high(-1e300);
        for (const glm::dvec2& p : hull) {
            const glm::dvec2 q(glm::dot(x, p), crossOf(x, p));
            low = glm::min(low, q);
            high = glm::max(high, q);
        }
        const double area = (high.x - low.x) * (high.y - low.y);
        // The margin keeps the choice among equal boxes from hanging on rounding.
        if (area < bestArea * (1 - 1e-9)) {
            bestArea = area;
            axis = x;
        }
    }

    glm::dvec2 low(1e300), high(-1e300);
    const auto turn = [&] {
        low = glm::dvec2(1e300);
        high = glm::dvec2(-1e300);
        for (glm::dvec2& p : uv) {
            p = {glm::dot(axis, p), crossOf(axis, p)};
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    };
    turn();
    if (high.y - low.y > high.x - low.x) {
        axis = {0, 1};
        turn();
    }
    for (glm::dvec2& p : uv) p -= low;
    return high - low;
}

}  // namespace phat
