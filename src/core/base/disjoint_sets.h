#pragma once
// Union-find: which items belong together, after any number of pairs were joined.

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace phat {

/// The smallest item of a set represents it. source: Tarjan and van Leeuwen 1984, path halving.
class DisjointSets {
  public:
    /// Each item is a set of its own.
    explicit DisjointSets(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    /// Item i begins in the set of parent[i]. pre: parent[i] <= i
    explicit DisjointSets(std::vector<uint32_t> parent) : parent_(std::move(parent)) {
        for (size_t i = 0; i < parent_.size(); ++i) assert(parent_[i] <= i);
    }

    uint32_t find(uint32_t item) {
        while (parent_[item] != item) item = parent_[item] = parent_[parent_[item]];
        return item;
    }
    void unite(uint32_t a, uint32_t b) {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }
    size_t size() const { return parent_.size(); }

  private:
    std::vector<uint32_t> parent_;
};

}  // namespace phat
