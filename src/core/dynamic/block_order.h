#pragma once
// The order in which the light of an atlas's blocks is made anew, one sample a texel at a time.

#include <vector>

#include "core/atlas/atlas.h"
#include "core/scene/scene.h"

namespace phat {

/// A block and how often its light has been made since it changed.
struct BlockTurn {
    uint32_t block = 0, rounds = 0;
};

class BlockOrder {
  public:
    /// `points`: of the scene at rest.
    BlockOrder(const Atlas& atlas, const TexelPoints& points);

    /// All light may be another one from now on.
    void noteChange();
    /// The next `count` blocks, or fewer once settled; they count as made. Those in the view have four times
    /// as many rounds as others until all have `kSettledRounds`, so that the age of every block is bounded.
    std::vector<BlockTurn> next(size_t count, const Camera& eye);
    /// Whether more rounds change nothing that could be seen.
    bool settled() const { return unsettled_ == 0; }
    size_t size() const { return places_.size(); }

    static constexpr uint32_t kSettledRounds = 128;

  private:
    struct Place {
        glm::vec3 center{0}, normal{0};
        float radius = 0;
    };
    std::vector<Place> places_;
    std::vector<uint32_t> rounds_;
    size_t unsettled_ = 0;
};

}  // namespace phat
