#pragma once
// Where indirect light comes from, learnt from photons: directions for paths that leave diffuse surfaces.
// source: Jensen 1995, "Importance Driven Path Tracing using the Photon Map".

#include <array>
#include <span>

#include "core/transport/photon_map.h"

namespace phat {

/// Densities of directions, one for each region of space and axis of the normals. A path tracer that mixes
/// them with densities of its own stays unbiased, whatever the photons were.
class PathGuide {
  public:
    PathGuide() = default;  // knows nothing
    /// Of photons that were reflected; direct light has samplers of its own.
    explicit PathGuide(std::span<const Photon> photons);

    bool empty() const { return densities_.empty(); }

    static constexpr int kSize = 16;
    /// A histogram over the hemisphere, in equal-area cells (hemisphere_map.h).
    struct Density {
        Frame frame;
        std::array<float, kSize> rowEnds{};             // cumulated, the last is 1
        std::array<float, kSize * kSize> columnEnds{};  // within a row, cumulated, the last is 1
        std::array<float, kSize * kSize> pdf{};         // 1/sr
    };
    /// For a point of a surface with this geometric normal; null where there are too few photons.
    const Density* at(glm::vec3 position, glm::vec3 normal) const;

  private:
    struct Node {
        uint32_t axis = 0;  // 3: a leaf
        float split = 0;
        int32_t below =
            -1;  // the node of what lies below the split, the next one is that above; or a density
    };
    void build(std::span<const Photon> photons, std::span<uint32_t> members, size_t node, const Frame& frame);

    std::vector<Node> nodes_;  // the first six: roots, by facing
    std::vector<Density> densities_;
};

/// A direction in world space, by the density's inverse.
glm::vec3 sampleGuide(const PathGuide::Density& density, glm::vec2 square);
/// 1/sr; 0 under the density's horizon.
float sampleGuidePdf(const PathGuide::Density& density, glm::vec3 direction);

}  // namespace phat
