#include "core/bvh/binary_tree.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <numeric>

namespace phat {
namespace {

constexpr int kBins = 32;
/// Below this count a second thread costs more than it brings. Not tuned.
constexpr uint32_t kParallelCount = 4096;

void add(Bounds& bounds, const Bounds& other) {
    bounds.low = glm::min(bounds.low, other.low);
    bounds.high = glm::max(bounds.high, other.high);
}

struct Split {
    int axis = -1;  // < 0: none
    int bin = 0;    // the first of the second half
    float cost = 0;
};

/// Bins of equal width over the centres of a range of boxes.
struct BinGrid {
    Bounds centers;

    int binOf(glm::vec3 center, int axis) const {
        const float extent = centers.high[axis] - centers.low[axis];
        return std::min(int(float(kBins) * ((center[axis] - centers.low[axis]) / extent)), kBins - 1);
    }
};

class Builder {
  public:
    Builder(std::span<const Bounds> boxes, int maxDepth, BinaryTree& tree)
        : boxes_(boxes), tree_(tree), maxDepth_(maxDepth) {}

    // Fills the 2 count - 1 nodes from `node` on. Each call writes its own nodes and its own range of the
    // order, so that the result does not depend on the threads.
    void build(uint32_t node, uint32_t first, uint32_t count, int depth) {
        BinaryNode& made = tree_.nodes[node];
        made.first = first;
        made.count = count;
        BinGrid grid;
        for (uint32_t i = first; i < first + count; ++i) {
            add(made.bounds, boxes_[tree_.order[i]]);
            grid.centers.add(boxes_[tree_.order[i]].center());
        }
        if (count == 1) return;
        const uint32_t left = partition(grid, first, count, maxDepth_ - depth - 1);
        made.right = node + 2 * left;
        const auto buildLeft = [&] { build(node + 1, first, left, depth + 1); };
        const auto buildRight = [&] { build(made.right, first + left, count - left, depth + 1); };
        if (count < kParallelCount) {
            buildLeft();
            buildRight();
        } else {
            tbb::parallel_invoke(buildLeft, buildRight);
        }
    }

  private:
    // Returns the count of the first half. `levels`: that are left below the halves.
    uint32_t partition(const BinGrid& grid, uint32_t first, uint32_t count, int levels) {
        const auto begin = tree_.order.begin() + first, end = begin + count;
        const Split split = bestSplit(grid, first, count);
        if (split.axis >= 0) {
            const auto middle = std::partition(begin, end, [&](uint32_t box) {
                return grid.binOf(boxes_[box].center(), split.axis) < split.bin;
            });
            const uint32_t left = uint32_t(middle - begin), larger = std::max(left, count - left);
            if (levels >= int(std::bit_width(larger - 1))) return left;
        }
        const glm::vec3 extent = grid.centers.high - grid.centers.low;
        const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
        std::nth_element(begin, begin + count / 2, end, [&](uint32_t a, uint32_t b) {
            const float x = boxes_[a].center()[axis], y = boxes_[b].center()[axis];
            return x < y || (x == y && a < b);
        });
        return count / 2;
    }

    Split bestSplit(const BinGrid& grid, uint32_t first, uint32_t count) const {
        Split best;
        for (int axis = 0; axis < 3; ++axis) {
            // Written so that an extent that overflows is none, either.
            const float extent = grid.centers.high[axis] - grid.centers.low[axis];
            if (!(extent > 0 && extent < std::numeric_limits<float>::infinity())) continue;
            std::array<Bounds, kBins> bounds;
            std::array<uint32_t, kBins> counts{};
            for (uint32_t i = first; i < first + count; ++i) {
                const Bounds& box = boxes_[tree_.order[i]];
                const int bin = grid.binOf(box.center(), axis);
                add(bounds[size_t(bin)], box);
                ++counts[size_t(bin)];
            }
            improve(best, axis, bounds, counts);
        }
        return best;
    }

    static void improve(Split& best, int axis, const std::array<Bounds, kBins>& bounds,
                        const std::array<uint32_t, kBins>& counts) {
        std::array<float, kBins> rightCost{};
        Bounds right, left;
        uint32_t rightCount = 0, leftCount = 0;
        for (size_t bin = kBins - 1; bin > 0; --bin) {
            add(right, bounds[bin]);
            rightCount += counts[bin];
            rightCost[bin] = rightCount == 0 ? -1.0f : halfArea(right) * float(rightCount);
        }
        for (size_t bin = 1; bin < kBins; ++bin) {
            add(left, bounds[bin - 1]);
            leftCount += counts[bin - 1];
            if (leftCount == 0 || rightCost[bin] < 0) continue;
            const float cost = halfArea(left) * float(leftCount) + rightCost[bin];
            if (best.axis < 0 || cost < best.cost) best = {axis, int(bin), cost};
        }
    }

    std::span<const Bounds> boxes_;
    BinaryTree& tree_;
    int maxDepth_;
};

}  // namespace

float halfArea(const Bounds& bounds) {
    if (bounds.empty()) return 0;
    const glm::vec3 d = bounds.high - bounds.low;
    return d.x * d.y + d.y * d.z + d.z * d.x;
}

BinaryTree buildBinaryTree(std::span<const Bounds> boxes, int maxDepth) {
    assert(!boxes.empty() && int(std::bit_width(boxes.size() - 1)) <= maxDepth);
    BinaryTree tree;
    tree.nodes.resize(2 * boxes.size() - 1);
    tree.order.resize(boxes.size());
    std::iota(tree.order.begin(), tree.order.end(), 0u);
    Builder(boxes, maxDepth, tree).build(0, 0, uint32_t(boxes.size()), 0);
    return tree;
}

}  // namespace phat
