#pragma once
// Reuse of neighbouring pixels' reflection rays. As shaders/pool.frag does with samples, but weighted by
// where the rays lead, because near surfaces have parallax between pixels. ours, because an image of a few
// rays a pixel is noise.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <glm/glm.hpp>
#include <vector>

namespace phat {

/// A mirror's lobe is sharper than a pixel: it needs no other's rays, and its own find what emits without
/// light samples.
inline constexpr float kMinPooledAlpha = 0.005f;
/// Of a mirror's lobe its rays are in the inner part, up to three alpha from its middle. A ray of the rest,
/// which has a tenth of the light, would be all that its pixel shows: a speck. A clamp.
inline constexpr float kMirrorPart = 0.9f;

/// A lobe that a pixel shows.
struct PooledLobe {
    uint32_t pixel = 0;            // y * width + x
    uint32_t side = 0;             // of which surface: lobes of one side may be pooled
    glm::vec3 position{0};         // world
    glm::vec3 towardEye{0, 1, 0};  // world, unit
    glm::vec3 mirror{0};           // the same, reflected
    float alpha = 0;               // 0: no lobe
    float distance = 0;            // metres to the nearest surface around `mirror`
};

/// Incident radiance by the rays of a lobe.
struct PooledLight {
    glm::vec3 indirect{0}, area{0};  // means
    float weight = 0;                // sum of the rays'
};

/// Which of its neighbours' rays count for a lobe, and how much.
class ReflectionPool {
  public:
    /// `width`: of the picture in pixels; at most one lobe a pixel. Takes over `lobes`.
    ReflectionPool(std::vector<PooledLobe> lobes, int width, int height);

    /// What changes from lobe `i` to those of the same side in the next pixels, along x and along y; 0 where
    /// there are none. source: ray differentials (Igehy 1999), by the rays themselves.
    struct Steps {
        glm::vec3 position[2] = {}, mirror[2] = {};
    };
    Steps steps(size_t i) const;

    /// How many rays count for each that lobe `i` traces itself if all trace as many, 1 to 16.
    float raysForOne(size_t i) const;

    /// Firefly redistribution. Walks that reach an emitter by way of two sharp lobes are rare and bright. The
    /// part of a lobe's indirect light that exceeds kMaxOverNeighbors times the mean of its neighbours is
    /// spread over them, up to kMaxRedistributed. A bias: the rest is lost. `lights`: of all lobes.
    struct Redistribution {
        float retained = 1;   // fraction of the lobe's own light
        glm::vec3 spread{0};  // added to each neighbour, times its tent weight
    };
    Redistribution redistribute(size_t i, const std::vector<PooledLight>& lights) const;

    /// Incident light of lobe `i` by its own rays and its neighbours'. `redistributions`: of all lobes.
    PooledLight pooled(size_t i, const std::vector<PooledLight>& lights,
                       const std::vector<Redistribution>& redistributions) const;

  private:
    // Calls visit(j, tent) for all lobes of the same side nearby, `i` among them, without regard to their
    // directions.
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

    // Calls visit(j, weight) for the lobes of positive weight; `i` itself has the greatest: 16.
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
