// Radiance and irradiance from the density of photons. source: Jensen 2001, section 7.

#include "core/transport/photon_adjoint.h"
#include "core/transport/photon_map.h"

namespace phat {
namespace {

constexpr float kMinNormalCosine = 0.5f;  // 60 degrees

// Photons at one point would have no area. A bound on the brightness, far below what any map resolves.
constexpr float kMinRadiusFraction = 1e-4f;  // of the largest radius

// Sum of contribution(photon) over a disc, divided by the disc's area.
template <typename Contribution>
glm::vec3 densityOf(const PhotonSet& photons, glm::vec3 position, glm::vec3 normal,
                    const DensityEstimate& settings, bool (*keep)(const Photon&), Contribution contribution) {
    const std::vector<Photon>& map = photons.photons.photons;
    const auto counts = [&](uint32_t i) {
        const Photon& photon = map[i];
        return glm::dot(photon.normal, normal) >= kMinNormalCosine && (!keep || keep(photon));
    };
    // One photon alone is a rim with nothing inside.
    const uint32_t k = std::max(settings.neighbors, 2u);
    std::vector<PhotonIndex::Neighbor> neighbors;
    const float maxRadius = settings.maxRadiusMeters(photons.photons);
    photons.index.nearest(position, k, maxRadius, std::cref(counts), neighbors);
    float radiusSquared = square(maxRadius);
    if (neighbors.size() == k) {
        radiusSquared =
            std::max(neighbors.back().distanceSquared, square(kMinRadiusFraction) * radiusSquared);
        neighbors.pop_back();
    }
    glm::vec3 sum(0);
    for (const PhotonIndex::Neighbor& neighbor : neighbors) sum += contribution(map[neighbor.photon]);
    return radiusSquared > 0 ? sum / (kPi * radiusSquared) : glm::vec3(0);
}

}  // namespace

glm::vec3 photonRadiance(const PhotonSet& photons, const SurfacePoint& point, glm::vec3 towardEye,
                         const DensityEstimate& settings, bool (*keep)(const Photon&)) {
    const glm::vec3 towardEyeLocal = point.shading.toLocal(towardEye);
    return densityOf(
        photons, point.position, point.normalGeometric, settings, keep, [&](const Photon& photon) {
            return photon.fluxWatts * perArrivingFlux(point.brdf, towardEyeLocal,
                                                      point.shading.toLocal(photon.towardOrigin),
                                                      glm::dot(photon.towardOrigin, photon.normal));
        });
}

glm::vec3 photonIrradiance(const PhotonSet& photons, glm::vec3 position, glm::vec3 normal,
                           const DensityEstimate& settings, bool (*keep)(const Photon&)) {
    return densityOf(photons, position, normal, settings, keep,
                     [](const Photon& photon) { return photon.fluxWatts; });
}

}  // namespace phat
