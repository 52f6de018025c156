#include "core/atlas/unwrap_grow.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <queue>
#include <set>
#include <tuple>

namespace phat {
namespace {

constexpr uint32_t kNone = ~0u;

// The piece of surface with local triangle numbers, so that scratch arrays are as small as the piece.
struct Patch {
    std::vector<std::array<uint32_t, 3>> neighbors;
    std::vector<glm::dvec3> normal;
    std::vector<double> area;

    uint32_t count() const { return uint32_t(normal.size()); }
};

Patch extractPatch(const MeshTopology& topology, std::span<const uint32_t> triangles) {
    Patch patch;
    patch.neighbors.resize(triangles.size());
    for (size_t t = 0; t < triangles.size(); ++t) {
        for (int edge = 0; edge < 3; ++edge) {
            const uint32_t across = topology.neighborAcross[triangles[t]][edge];
            const auto found = std::lower_bound(triangles.begin(), triangles.end(), across);
            const bool inside = across != kNoNeighbor && found != triangles.end() && *found == across;
            patch.neighbors[t][edge] = inside ? uint32_t(found - triangles.begin()) : kNone;
        }
        patch.normal.push_back(topology.faceNormal[triangles[t]]);
        patch.area.push_back(topology.faceArea[triangles[t]]);
    }
    return patch;
}

struct Candidate {
    double cost;
    uint32_t triangle;
    uint32_t chart;

    // The priority queue pops its greatest first; ties go to the lower numbers.
    bool operator<(const Candidate& other) const {
        return std::tie(cost, triangle, chart) > std::tie(other.cost, other.triangle, other.chart);
    }
};

glm::dvec3 normalizeOr(glm::dvec3 v, glm::dvec3 fallback) {
    const double length = glm::length(v);
    return length > 1e-12 ? v / length : fallback;
}

class Grower {
  public:
    Grower(const Patch& patch, double cosCone, const Progress& progress)
        : patch_(patch), cosCone_(cosCone), progress_(progress), chartOf_(patch.count(), kNone) {}

    // One chart after another from the largest free triangle, each around its own running mean normal.
    void growFreeTriangles() {
        std::vector<uint32_t> order;
        for (uint32_t t = 0; t < patch_.count(); ++t)
            if (chartOf_[t] == kNone) order.push_back(t);
        std::stable_sort(order.begin(), order.end(),
                         [&](uint32_t a, uint32_t b) { return patch_.area[a] > patch_.area[b]; });
        for (const uint32_t seed : order) {
            if (chartOf_[seed] != kNone) continue;
            progress_.throwIfStopped();
            const uint32_t chart = uint32_t(axis_.size());
            axis_.push_back(patch_.normal[seed]);
            std::priority_queue<Candidate> queue;
            queue.push({0, seed, chart});
            glm::dvec3 sum(0);
            while (!queue.empty()) {
                const uint32_t t = queue.top().triangle;
                queue.pop();
                if (chartOf_[t] != kNone || glm::dot(patch_.normal[t], axis_[chart]) < cosCone_) continue;
                chartOf_[t] = chart;
                sum += patch_.area[t] * patch_.normal[t];
                axis_[chart] = normalizeOr(sum, axis_[chart]);
                pushNeighbors(queue, t, chart);
            }
        }
    }

    // All charts at once, each from the triangle that represents it best, around the mean normals of before.
    void regrow() {
        progress_.throwIfStopped();
        updateAxes();
        std::vector<Candidate> seeds(axis_.size(), {1e30, kNone, 0});
        for (uint32_t t = 0; t < patch_.count(); ++t) {
            const uint32_t chart = chartOf_[t];
            const double cost = 1 - glm::dot(patch_.normal[t], axis_[chart]);
            if (cost < seeds[chart].cost) seeds[chart] = {cost, t, chart};
        }
        std::fill(chartOf_.begin(), chartOf_.end(), kNone);
        std::priority_queue<Candidate> queue;
        for (const Candidate& seed : seeds)
            if (seed.triangle != kNone) queue.push(seed);
        while (!queue.empty()) {
            const Candidate next = queue.top();
            queue.pop();
            if (chartOf_[next.triangle] != kNone) continue;
            chartOf_[next.triangle] = next.chart;
            pushNeighbors(queue, next.triangle, next.chart);
        }
        growFreeTriangles();
    }

    // Merges neighbours, smallest chart first, while all normals of the union fit in the cone.
    void merge() {
        updateAxes();
        const size_t count = axis_.size();
        std::vector<std::vector<uint32_t>> members(count);
        std::vector<double> area(count, 0.0);
        std::vector<glm::dvec3> sum(count, glm::dvec3(0));
        std::vector<std::map<uint32_t, double>> border(count);  // shared edges by neighbouring chart
        for (uint32_t t = 0; t < patch_.count(); ++t) {
            const uint32_t chart = chartOf_[t];
            members[chart].push_back(t);
            area[chart] += patch_.area[t];
            sum[chart] += patch_.area[t] * patch_.normal[t];
            for (const uint32_t n : patch_.neighbors[t])
                if (n != kNone && chartOf_[n] != chart) border[chart][chartOf_[n]] += 1;
        }
        const auto fits = [&](uint32_t chart, glm::dvec3 axis) {
            return std::all_of(members[chart].begin(), members[chart].end(),
                               [&](uint32_t t) { return glm::dot(patch_.normal[t], axis) >= cosCone_; });
        };

        std::set<std::pair<double, uint32_t>> smallest;
        for (uint32_t c = 0; c < count; ++c)
            if (!members[c].empty()) smallest.insert({area[c], c});
        while (!smallest.empty()) {
            const uint32_t small = smallest.begin()->second;
            smallest.erase(smallest.begin());
            progress_.throwIfStopped();
            // Most similar neighbour first.
            std::vector<std::pair<double, uint32_t>> options;
            for (const auto& [other, edges] : border[small])
                options.emplace_back(-glm::dot(axis_[other], axis_[small]), other);
            std::sort(options.begin(), options.end());
            for (const auto& [cost, other] : options) {
                const glm::dvec3 axis = normalizeOr(sum[small] + sum[other], axis_[other]);
                if (!fits(small, axis) || !fits(other, axis)) continue;
                smallest.erase({area[other], other});
                if (members[other].size() < members[small].size()) members[other].swap(members[small]);
                members[other].insert(members[other].end(), members[small].begin(), members[small].end());
                members[small] = {};
                area[other] += area[small];
                sum[other] += sum[small];
                axis_[other] = axis;
                for (const auto& [neighbor, edges] : border[small]) {
                    border[neighbor].erase(small);
                    if (neighbor == other) continue;
                    border[neighbor][other] += edges;
                    border[other][neighbor] += edges;
                }
                border[small] = {};
                smallest.insert({area[other], other});
                break;
            }
        }
        renumber(members);
    }

    const std::vector<uint32_t>& chartOf() const { return chartOf_; }

  private:
    /// Numbers the charts that still have triangles.
    void renumber(const std::vector<std::vector<uint32_t>>& members) {
        uint32_t next = 0;
        for (uint32_t c = 0; c < members.size(); ++c) {
            if (members[c].empty()) continue;
            for (const uint32_t t : members[c]) chartOf_[t] = next;
            axis_[next++] = axis_[c];
        }
        axis_.resize(next);
    }
    void pushNeighbors(std::priority_queue<Candidate>& queue, uint32_t t, uint32_t chart) {
        for (const uint32_t n : patch_.neighbors[t]) {
            if (n == kNone || chartOf_[n] != kNone) continue;
            const double cosine = glm::dot(patch_.normal[n], axis_[chart]);
            if (cosine < cosCone_) continue;
            // A triangle that already touches the chart on two sides fills a notch: taking it early keeps
            // outlines short. Not sensitive: .25 to .7 change the number of charts of a torus from 44 to 46
            // at most.
            int touching = 0;
            for (const uint32_t nn : patch_.neighbors[n]) touching += nn != kNone && chartOf_[nn] == chart;
            queue.push({(1 - cosine) * (touching > 1 ? 0.5 : 1.0), n, chart});
        }
    }

    void updateAxes() {
        std::vector<glm::dvec3> sum(axis_.size(), glm::dvec3(0));
        for (uint32_t t = 0; t < patch_.count(); ++t) sum[chartOf_[t]] += patch_.area[t] * patch_.normal[t];
        for (size_t c = 0; c < axis_.size(); ++c) axis_[c] = normalizeOr(sum[c], axis_[c]);
    }

    const Patch& patch_;
    const double cosCone_;
    const Progress& progress_;
    std::vector<uint32_t> chartOf_;
    std::vector<glm::dvec3> axis_;
};

std::vector<std::vector<uint32_t>> collectPieces(const Patch& patch, const std::vector<uint32_t>& chartOf,
                                                 std::span<const uint32_t> triangles) {
    std::vector<std::vector<uint32_t>> pieces;
    std::vector<bool> visited(patch.count(), false);
    std::vector<uint32_t> stack;
    for (uint32_t first = 0; first < patch.count(); ++first) {
        if (visited[first]) continue;
        std::vector<uint32_t> piece;
        stack.push_back(first);
        visited[first] = true;
        while (!stack.empty()) {
            const uint32_t t = stack.back();
            stack.pop_back();
            piece.push_back(triangles[t]);
            for (const uint32_t n : patch.neighbors[t]) {
                if (n == kNone || visited[n] || chartOf[n] != chartOf[t]) continue;
                visited[n] = true;
                stack.push_back(n);
            }
        }
        std::sort(piece.begin(), piece.end());
        pieces.push_back(std::move(piece));
    }
    return pieces;
}

// Triangles in breadth-first order from `start`.
std::vector<uint32_t> breadthFirst(const Patch& patch, uint32_t start) {
    std::vector<uint32_t> order{start};
    std::vector<bool> visited(patch.count(), false);
    visited[start] = true;
    for (size_t i = 0; i < order.size(); ++i)
        for (const uint32_t n : patch.neighbors[order[i]])
            if (n != kNone && !visited[n]) {
                visited[n] = true;
                order.push_back(n);
            }
    return order;
}

}  // namespace

std::vector<std::vector<uint32_t>> growCharts(const MeshTopology& topology,
                                              std::span<const uint32_t> triangles, double cosCone,
                                              const Progress& progress) {
    const Patch patch = extractPatch(topology, triangles);
    Grower grower(patch, cosCone, progress);
    grower.growFreeTriangles();
    // Two rounds settle it: a third made 47 charts instead of 44 of a torus, 834 instead of 829 of a rough
    // plane.
    for (int round = 0; round < 2; ++round) {
        grower.merge();
        grower.regrow();
    }
    grower.merge();
    return collectPieces(patch, grower.chartOf(), triangles);
}

std::vector<std::vector<uint32_t>> bisectChart(const MeshTopology& topology,
                                               std::span<const uint32_t> triangles) {
    const Patch patch = extractPatch(topology, triangles);
    // From one end of the piece: the nearer half by hops and what is left. The rest may fall apart.
    const uint32_t end = breadthFirst(patch, 0).back();
    const std::vector<uint32_t> order = breadthFirst(patch, end);
    const double total = std::accumulate(patch.area.begin(), patch.area.end(), 0.0);
    std::vector<uint32_t> half(patch.count(), 1);
    double area = 0;
    for (size_t i = 0; i + 1 < order.size() && (i == 0 || area < 0.5 * total); ++i) {
        half[order[i]] = 0;
        area += patch.area[order[i]];
    }
    return collectPieces(patch, half, triangles);
}

std::vector<std::vector<uint32_t>> connectedPieces(const MeshTopology& topology,
                                                   std::span<const uint32_t> triangles) {
    const Patch patch = extractPatch(topology, triangles);
    return collectPieces(patch, std::vector<uint32_t>(patch.count(), 0), triangles);
}

}  // namespace phat
