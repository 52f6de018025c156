#pragma once
// Photon tracing and density estimation. source: Jensen 2001; Hensley et al. 2003, section 5.

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/scene/lights.h"
#include "core/scene/rays.h"

namespace phat {

/// A photon where it met a surface.
struct Photon {
    glm::vec3 position{0};
    glm::vec3 fluxWatts{0};
    glm::vec3 towardOrigin{0};  // unit, opposite to its propagation
    glm::vec3 normal{0};        // geometric, on the side that it arrived at
    uint32_t triangle = kNoTriangle;
    bool firstHit = false;  // has not been reflected yet
    bool punctual = false;  // emitted by a punctual light
    bool backFace = false;
};

struct PhotonSettings {
    uint64_t count = 500'000;  // emitted
    int maxBounces = 16;
    uint64_t seed = 1;
};

/// Every emitted watt is accounted for: emitted = absorbed + escaped (within rounding), where "absorbed"
/// counts the photons that Russian roulette, maxBounces and a light's range end.
struct PhotonStats {
    uint64_t emitted = 0;
    uint64_t stored = 0;
    uint64_t belowSurface = 0;  // absorbed because the shading normal sent them under the real surface
    glm::dvec3 emittedWatts{0};
    glm::dvec3 absorbedWatts{0};
    glm::dvec3 escapedWatts{0};
};

struct PhotonMap {
    std::vector<Photon> photons;  // order independent of the number of threads
    float unitMeters = 1;         // lengthUnit() of the scene
    PhotonStats stats;
};

/// Photons are stored wherever they arrive on a side that reflects or shines, before the roulette.
/// Throws Interrupted when `progress` requests it, std::length_error when more than 2^32 photons would be
/// stored.
PhotonMap tracePhotons(const RayScene& rays, const LightSampler& lights, const PhotonSettings& settings,
                       Progress& progress);

/// Those of the emitted photons [begin, end) alone; the parts in order make the whole map.
/// pre: begin <= end <= settings.count.
PhotonMap tracePhotonPart(const RayScene& rays, const LightSampler& lights, const PhotonSettings& settings,
                          uint64_t begin, uint64_t end, Progress& progress);

/// k nearest photons within a radius. A kd-tree over positions; the photons must outlive it.
class PhotonIndex {
  public:
    explicit PhotonIndex(std::span<const Photon> photons);
    ~PhotonIndex();
    PhotonIndex(PhotonIndex&&) noexcept;

    struct Neighbor {
        uint32_t photon;
        float distanceSquared;
    };
    /// The k nearest within maxRadius (inclusive), nearest first and in photon order where equally near;
    /// `out` is cleared first.
    void nearest(glm::vec3 position, uint32_t k, float maxRadiusMeters, std::vector<Neighbor>& out) const;
    /// The same among the photons that `accept` takes.
    void nearest(glm::vec3 position, uint32_t k, float maxRadiusMeters,
                 const std::function<bool(uint32_t photon)>& accept, std::vector<Neighbor>& out) const;
    /// All within the radius (inclusive), in photon order.
    void within(glm::vec3 position, float radiusMeters, std::vector<Neighbor>& out) const;

  private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

/// Photons and their index: a whole map, or one of the parts that make it together.
struct PhotonSet {
    const PhotonMap& photons;
    const PhotonIndex& index;
};

struct DensityEstimate {
    uint32_t neighbors = 50;
    float maxRadius = 0.25f;  // in the units of the photons' scene

    float maxRadiusMeters(const PhotonMap& photons) const { return maxRadius * photons.unitMeters; }
};

/// Radiance reflected toward `towardEye` at `point` by the local photons: sum of f * flux / (pi r^2), r the
/// distance of the k-th, which only marks the rim and is not in the sum: for evenly spread photons that is
/// unbiased, where counting it would be k / (k - 1) too bright. Where fewer than k are found, all of them
/// over the disc of maxRadius. Photons on surfaces that face elsewhere (normals over 60 degrees apart) are
/// left out. `keep` selects photons (first hits, kinds); null: all.
glm::vec3 photonRadiance(const PhotonSet& photons, const SurfacePoint& point, glm::vec3 towardEye,
                         const DensityEstimate& settings, bool (*keep)(const Photon&));

/// Irradiance at a point by the same estimate.
glm::vec3 photonIrradiance(const PhotonSet& photons, glm::vec3 position, glm::vec3 normal,
                           const DensityEstimate& settings, bool (*keep)(const Photon&));

}  // namespace phat
