#pragma once
// The order in which the light of an atlas's blocks is made anew, one sample a texel at a time.

#include <vector>

#include "core/atlas/atlas.h"
#include "core/scene/scene.h"

namespace phat {

enum class BlockWork : uint8_t {
    check,       // PHATexels along the directions that they have; how much that changes is asked for
    irradiance,  // a sample of it
    all,         // the same, and PHATexels in new directions
};

/// A block and how often its light has been made since it changed.
struct BlockTurn {
    uint32_t block = 0, rounds = 0;
    BlockWork work = BlockWork::all;
    uint32_t kept = 4;  // samples that the irradiance of before the change counts as
};

class BlockOrder {
  public:
    /// `points`: of the scene at rest.
    BlockOrder(const Atlas& atlas, const TexelPoints& points);

    /// All light may be another one from now on: all blocks are to be checked.
    void noteChange();
    /// The next `count` blocks, or fewer once settled; they count as made. Those in the view have four times
    /// as many rounds as others until all have `kSettledRounds`, so that the age of every block is bounded.
    /// Blocks that no check has found to be changed have `kChecks` checks alone.
    std::vector<BlockTurn> next(size_t count, const Camera& eye);
    /// What a check has found: the sum over the block's PHATexels of the changes of radiance over that of the
    /// radiance, both over their densities.
    void noteCheck(uint32_t block, float change);
    /// Whether more rounds change nothing that could be seen.
    bool settled() const { return unsettled_ == 0; }
    size_t size() const { return places_.size(); }

    static constexpr uint32_t kSettledRounds = 128;
    static constexpr uint32_t kChecks = 4;
    /// Less change than this, all checks together, leaves the irradiance as it is.
    static constexpr float kAgrees = 0.01f;

  private:
    struct Place {
        glm::vec3 center{0}, normal{0};
        float radius = 0;
    };
    /// A block is checked until a check finds a change; then its light is made anew. Where a further change
    /// comes meanwhile, it is checked once more.
    struct State {
        bool changed = false, checkDue = false;
        bool lit = false;  // had a sample of irradiance since its last check
        uint32_t rounds = 0, checks = 0;
        float change = 0;   // that checks have found, as far as irradiance has not followed
        uint64_t turn = 0;  // its last
    };
    bool isSettled(const State& state) const;
    uint32_t roundsOf(const State& state) const;
    BlockTurn turnOf(uint32_t block);

    std::vector<Place> places_;
    std::vector<State> states_;
    size_t unsettled_ = 0;
    uint64_t turns_ = 0;
};

}  // namespace phat
