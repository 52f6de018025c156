#pragma once
// Rays of neighbouring pixels, put together. As shaders/pool.frag does with draws, but by where the rays
// lead: what is close stands elsewhere for each pixel. ours, because a picture of a few rays a pixel is
// noise.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <glm/glm.hpp>
#include <vector>

namespace phat {

/// A lobe that a pixel shows.
struct PooledLobe {
    uint32_t pixel = 0;     // y * width + x
    uint32_t side = 0;      // of which surface: two of one number share what they see
    glm::vec3 position{0};  // world
    glm::vec3 mirror{0};    // world, unit: the eye's, reflected
    float alpha = 0;        // 0: no lobe
    float distance = 0;     // metres to what is seen around `mirror`
};

/// What the rays of a lobe brought.
struct PooledLight {
    glm::vec3 indirect{0}, area{0};  // means
    float weight = 0;                // sum of the rays'
};

/// Which of its neighbours' rays count for a lobe, and how much.
class ReflectionPool {
  public:
    /// `width`: of the picture in pixels; at most one lobe a pixel. Takes over `lobes`.
    ReflectionPool(std::vector<PooledLobe> lobes, int width, int height);

    /// How many rays count for each that lobe `i` traces itself if all trace as many, 1 to 16.
    float raysForOne(size_t i) const;

    /// Walks that find a lamp by way of two sharp lobes are rare and bright. What of a lobe's indirect light
    /// is more than kMostTimesNear as bright as what those around see goes to them all, as far as that does
    /// not show. A bias: the rest is lost. `lights`: of all lobes.
    struct Share {
        float kept = 1;      // of its own
        glm::vec3 given{0};  // to each nearby, times its tent
    };
    Share shareOut(size_t i, const std::vector<PooledLight>& lights) const;

    /// What lobe `i` sees by its own rays and those that count for it. `shares`: shareOut of all.
    PooledLight pooled(size_t i, const std::vector<PooledLight>& lights,
                       const std::vector<Share>& shares) const;

  private:
    // Calls visit(j, tent) for all lobes of the same side nearby, `i` among them, whatever they see.
    template <typename Visit>
    void visitNear(size_t i, const Visit& visit) const {
        const PooledLobe& mine = lobes_[i];
        const int x = int(mine.pixel) % width_, y = int(mine.pixel) / width_;
        for (int v = std::max(y - kReach, 0); v <= std::min(y + kReach, height_ - 1); ++v)
            for (int u = std::max(x - kReach, 0); u <= std::min(x + kReach, width_ - 1); ++u) {
                const uint32_t j = lobeOf_[size_t(v) * size_t(width_) + size_t(u)];
                if (j != kNoLobe && lobes_[j].side == mine.side)
                    visit(j, float((kReach + 1 - std::abs(u - x)) * (kReach + 1 - std::abs(v - y))));
            }
    }

    // Calls visit(j, weight) for those that count, `i` with the most: 16.
    template <typename Visit>
    void visit(size_t i, const Visit& visit) const {
        visitNear(i, [&](size_t j, float tent) {
            if (const float weight = tent * likeness(lobes_[i], lobes_[j]); weight > 0) visit(j, weight);
        });
    }

    static constexpr int kReach = 3;  // pixels, as in shaders/pool.frag
    static constexpr float kOwnTent = (kReach + 1) * (kReach + 1);
    static constexpr uint32_t kNoLobe = ~0u;
    static float likeness(const PooledLobe& mine, const PooledLobe& other);

    std::vector<PooledLobe> lobes_;
    std::vector<uint32_t> lobeOf_;  // [pixel]
    int width_, height_;
};

}  // namespace phat
