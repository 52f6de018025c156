#include "core/atlas/box_parts.h"

#include <algorithm>
#include <map>
#include <queue>
#include <tuple>

#include "core/atlas/piece_place.h"
#include "core/atlas/unwrap_flatten.h"

namespace phat {
namespace {

// What a texel of a cut's length costs, in texels: on both sides its values are extrapolated and stitched.
constexpr double kSeamCost = 1;

struct Part {
    std::vector<uint32_t> triangles;    // of the chart, by index
    std::vector<glm::dvec2> hull;       // texels
    std::map<uint32_t, double> border;  // length shared with neighbouring parts, texels
    double texels = 0;
    uint32_t version = 0;  // merges so far
};

// About the texels of a piece in such a box.
double texelsInBox(std::vector<glm::dvec2> hull) {
    const glm::dvec2 size = alignToBox(hull);
    const auto along = [](double length) { return isNarrow(length) ? 1 : length + 1; };
    return along(size.x) * along(size.y);
}

struct Merge {
    double gain = 0;  // texels
    uint32_t a = 0, b = 0, versionA = 0, versionB = 0;

    // The priority queue pops the greatest first; ties go to the lower numbers.
    bool operator<(const Merge& other) const {
        return std::tie(gain, other.a, other.b) < std::tie(other.gain, a, b);
    }
};

class Merger {
  public:
    Merger(const MeshTopology& topology, const FlatChart& chart, double texelSizeMeters)
        : parts_(chart.triangles.size()) {
        for (uint32_t t = 0; t < parts_.size(); ++t) {
            Part& part = parts_[t];
            part.triangles = {t};
            for (const glm::dvec2& corner : chart.uvMeters[t]) part.hull.push_back(corner / texelSizeMeters);
            part.texels = texelsInBox(part.hull);
            for (int edge = 0; edge < 3; ++edge) {
                const uint32_t across = topology.neighborAcross[chart.triangles[t]][edge];
                const auto found = std::lower_bound(chart.triangles.begin(), chart.triangles.end(), across);
                if (across == kNoNeighbor || found == chart.triangles.end() || *found != across) continue;
                part.border[uint32_t(found - chart.triangles.begin())] +=
                    glm::distance(part.hull[size_t(edge)], part.hull[size_t(edge + 1) % 3]);
            }
        }
    }

    void run() {
        for (uint32_t a = 0; a < parts_.size(); ++a)
            for (const auto& [b, length] : parts_[a].border)
                if (a < b) offer(a, b);
        while (!queue_.empty()) {
            const Merge best = queue_.top();
            queue_.pop();
            if (parts_[best.a].version == best.versionA && parts_[best.b].version == best.versionB)
                merge(best.a, best.b);
        }
    }

    std::vector<std::vector<uint32_t>> parts(const FlatChart& chart) const {
        std::vector<std::vector<uint32_t>> result;
        for (const Part& part : parts_) {
            if (part.triangles.empty()) continue;
            std::vector<uint32_t>& triangles = result.emplace_back();
            for (const uint32_t t : part.triangles) triangles.push_back(chart.triangles[t]);
            std::sort(triangles.begin(), triangles.end());
        }
        std::sort(result.begin(), result.end());
        return result;
    }

    double texels() const {
        double sum = 0;
        for (const Part& part : parts_) sum += part.texels;
        return sum;
    }

  private:
    static std::vector<glm::dvec2> hullOf(const Part& a, const Part& b) {
        std::vector<glm::dvec2> corners = a.hull;
        corners.insert(corners.end(), b.hull.begin(), b.hull.end());
        return convexHull(std::move(corners));
    }

    void offer(uint32_t a, uint32_t b) {
        const Part &first = parts_[a], &second = parts_[b];
        const double gain = first.texels + second.texels + kSeamCost * first.border.at(b) -
                            texelsInBox(hullOf(first, second));
        if (gain >= 0) queue_.push({gain, a, b, first.version, second.version});
    }

    // Part `b` becomes one with part `a`.
    void merge(uint32_t a, uint32_t b) {
        Part &whole = parts_[a], &other = parts_[b];
        whole.hull = hullOf(whole, other);
        whole.texels = texelsInBox(whole.hull);
        whole.triangles.insert(whole.triangles.end(), other.triangles.begin(), other.triangles.end());
        for (const auto& [neighbor, length] : other.border) {
            parts_[neighbor].border.erase(b);
            if (neighbor == a) continue;
            whole.border[neighbor] += length;
            parts_[neighbor].border[a] += length;
        }
        const uint32_t merges = other.version + 1;
        other = {};
        other.version = merges;
        ++whole.version;
        for (const auto& [neighbor, length] : whole.border)
            offer(std::min(a, neighbor), std::max(a, neighbor));
    }

    std::vector<Part> parts_;  // empty: became part of another
    std::priority_queue<Merge> queue_;
};

}  // namespace

std::vector<std::vector<uint32_t>> partsWithSmallBoxes(const MeshTopology& topology, const FlatChart& chart,
                                                       double texelSizeMeters) {
    Merger merger(topology, chart, texelSizeMeters);
    merger.run();
    // What saves most at each step need not lead to the least.
    const glm::dvec2 size = chart.sizeMeters / texelSizeMeters;
    if (merger.texels() >= texelsInBox({glm::dvec2(0), {size.x, 0}, size})) return {chart.triangles};
    return merger.parts(chart);
}

}  // namespace phat
