#include "core/bvh/wide_tree.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace phat {
namespace {

class Collapse {
  public:
    Collapse(const BinaryTree& tree, const WideCosts& costs)
        : tree_(tree), costs_(costs), cost_(tree.nodes.size()), isLeaf_(tree.nodes.size()) {
        for (size_t i = tree.nodes.size(); i-- > 0;) evaluate(uint32_t(i));
    }

    // Depth first, so that what is near in space is near in memory.
    std::vector<WideNode> emit() const {
        struct Pending {
            uint32_t wide, binary;
        };
        std::vector<WideNode> wide(1);
        std::vector<Pending> pending{{0, 0}};
        while (!pending.empty()) {
            const Pending at = pending.back();
            pending.pop_back();
            WideNode node = nodeOf(at.binary);
            node.firstInner = uint32_t(wide.size());
            for (int child = node.innerCount; child-- > 0;)
                pending.push_back({node.firstInner + uint32_t(child), node.children[size_t(child)]});
            wide.resize(wide.size() + size_t(node.innerCount));
            wide[at.wide] = node;
        }
        return wide;
    }

  private:
    // Least costs of a subtree as at most 1, 2, 3, 4 children of a wide node.
    using Costs = std::array<float, kBvhWidth>;

    float split(uint32_t node, int budget, int forLeft) const {
        return cost_[node + 1][size_t(forLeft - 1)] +
               cost_[tree_.nodes[node].right][size_t(budget - forLeft - 1)];
    }

    float bestSplit(uint32_t node, int budget) const {
        float best = split(node, budget, 1);
        for (int forLeft = 2; forLeft < budget; ++forLeft)
            best = std::min(best, split(node, budget, forLeft));
        return best;
    }

    void evaluate(uint32_t node) {
        const BinaryNode& binary = tree_.nodes[node];
        Costs& cost = cost_[node];
        const float area = halfArea(binary.bounds);
        const float asLeaf = area * float(binary.count) * costs_.primitive;
        isLeaf_[node] = binary.isLeaf();
        cost.fill(asLeaf);
        if (binary.isLeaf()) return;
        const float asInner = area * costs_.node + bestSplit(node, kBvhWidth);
        isLeaf_[node] = binary.count <= costs_.maxLeaf && asLeaf <= asInner;
        cost[0] = isLeaf_[node] ? asLeaf : asInner;
        for (int budget = 2; budget <= kBvhWidth; ++budget)
            cost[size_t(budget - 1)] = std::min(cost[size_t(budget - 2)], bestSplit(node, budget));
    }

    // Appends the children that stand for a subtree.
    void addChildren(uint32_t node, int budget, std::vector<uint32_t>& children) const {
        const Costs& cost = cost_[node];
        while (budget > 1 && cost[size_t(budget - 1)] == cost[size_t(budget - 2)]) --budget;
        if (budget == 1)
            children.push_back(node);
        else
            addSplit(node, budget, children);
    }

    void addSplit(uint32_t node, int budget, std::vector<uint32_t>& children) const {
        int forLeft = 1;
        const float best = bestSplit(node, budget);
        while (forLeft + 1 < budget && split(node, budget, forLeft) != best) ++forLeft;
        addChildren(node + 1, forLeft, children);
        addChildren(tree_.nodes[node].right, budget - forLeft, children);
    }

    WideNode nodeOf(uint32_t binary) const {
        std::vector<uint32_t> children;
        if (tree_.nodes[binary].isLeaf())
            children.push_back(binary);  // a root of one box
        else
            addSplit(binary, kBvhWidth, children);
        std::stable_partition(children.begin(), children.end(),
                              [&](uint32_t child) { return !isLeaf_[child]; });
        WideNode node;
        node.childCount = int(children.size());
        node.innerCount = int(
            std::count_if(children.begin(), children.end(), [&](uint32_t child) { return !isLeaf_[child]; }));
        std::copy(children.begin(), children.end(), node.children.begin());
        return node;
    }

    const BinaryTree& tree_;
    const WideCosts& costs_;
    std::vector<Costs> cost_;   // [binary node]
    std::vector<bool> isLeaf_;  // [binary node]
};

}  // namespace

std::vector<WideNode> makeWideTree(const BinaryTree& tree, const WideCosts& costs) {
    assert(costs.maxLeaf >= 1);
    return Collapse(tree, costs).emit();
}

int stackWords(const std::vector<WideNode>& tree, LeafVisits leaves) {
    std::vector<int> words(tree.size(), 0);
    for (size_t i = tree.size(); i-- > 0;) {
        const WideNode& node = tree[i];
        for (int child = 0; child < node.innerCount; ++child)
            words[i] = std::max(words[i], words[node.firstInner + uint32_t(child)]);
        words[i] += (leaves == LeafVisits::none ? node.innerCount : node.childCount) > 1;
    }
    return words.empty() ? 0 : words[0];
}

BoxTree buildBoxTree(std::span<const Bounds> boxes, const WideCosts& costs, LeafVisits leaves,
                     int maxStackWords) {
    BoxTree tree;
    for (const int maxDepth : {kMaxTreeDepth, int(std::bit_width(boxes.size() - 1))}) {
        tree.binary = buildBinaryTree(boxes, maxDepth);
        tree.wide = makeWideTree(tree.binary, costs);
        tree.stackWords = stackWords(tree.wide, leaves);
        if (tree.stackWords <= maxStackWords) break;
    }
    return tree;
}

}  // namespace phat
