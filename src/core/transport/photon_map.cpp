#include "core/transport/photon_map.h"

#include <tbb/parallel_for.h>

#include <cassert>
#include <limits>
#include <stdexcept>

#include "core/scene/glass.h"
#include "core/scene/light_punctual.h"
#include "core/transport/photon_adjoint.h"

namespace phat {
namespace {

// Photons a task: large enough to hide the scheduling, small enough to stop within 100 ms.
constexpr uint64_t kBatchSize = 4096;

constexpr uint64_t kBounceStream = 0x9407;  // of hashOf

struct Batch {
    std::vector<Photon> photons;
    PhotonStats stats;
};

// A photon between two surfaces.
struct Flight {
    glm::vec3 origin;
    glm::vec3 direction;
    glm::vec3 fluxWatts;
    float rangeMeters = 0;  // of its light, until it has been reflected; 0: unlimited
};

// Reflects the photon off the surface, or ends it. Roulette follows the choice of direction and steers the
// brightest channel back to `fluxGoal`, what it was emitted with: dim photons end or catch up, and those that
// a surface made heavier (a coat lets in what it would reflect, so the BRDF is not symmetric) go on
// unchanged.
bool reflect(const RayScene& rays, const SurfacePoint& surface, float fluxGoal, Rng& rng, Flight& flight,
             PhotonStats& stats) {
    const glm::vec3 towardOrigin = -flight.direction;
    const glm::vec3 towardOriginLocal = surface.shading.toLocal(towardOrigin);
    const float lobe = rng.uniform();
    const BrdfSample sample = sampleBrdf(surface.brdf, towardOriginLocal, lobe, rng.uniform2());
    const float survival = rng.uniform();
    if (!(sample.pdf > 0)) return false;

    const glm::vec3 leaving = surface.shading.toWorld(sample.direction);
    const float cosLeaving = glm::dot(leaving, surface.normalGeometric);
    if (cosLeaving <= 0) {
        ++stats.belowSurface;
        return false;
    }
    const float cosArriving = glm::dot(towardOrigin, surface.normalGeometric);
    const glm::vec3 reflected =
        flight.fluxWatts * perArrivingFlux(surface.brdf, sample.direction, towardOriginLocal, cosArriving) *
        (cosLeaving / sample.pdf);
    const float chance = std::min(1.0f, maxComponent(reflected) / fluxGoal);
    if (!(survival < chance)) return false;
    flight = {rays.offsetOrigin(surface.position, surface.normalGeometric), leaving, reflected / chance};
    return true;
}

bool isBlackSide(const Scene& scene, const Hit& hit) {
    return hit.backFace && !scene.materialOf(hit.triangle).doubleSided;
}

// The next surface that a photon is reflected by or ends at, and its flux there. On glass it is stored each
// time that it comes from outside, before it is known whether it is transmitted.
struct Arrival {
    Hit hit;
    float wayMeters = 0;  // since the flight began
    bool stored = false;
};
Arrival throughGlass(const RayScene& rays, uint64_t seed, Photon photon, Flight& flight, Batch& batch) {
    const Scene& scene = rays.scene();
    const glm::vec3 flux = flight.fluxWatts;
    GlassWalk walk(rays, {flight.origin, flight.direction}, seed);
    Arrival arrival;
    for (bool passes = true; passes;) {
        arrival.hit = rays.closestHit(walk.ray().origin, walk.ray().direction);
        const Hit& hit = arrival.hit;
        arrival.wayMeters = walk.wayMeters() + hit.distance;
        flight.direction = walk.ray().direction;
        passes = false;
        if (!hit) break;
        const Glass glass = rays.glassOf(hit.triangle);
        if (glass == Glass::none) {
            walk.ends(hit);
            break;
        }
        arrival.stored = true;
        if (!isBlackSide(scene, hit) && !(glass == Glass::volume && hit.backFace)) {
            const SurfacePoint at = surfaceAt(scene, hit, flight.direction);
            photon.position = at.position;
            photon.fluxWatts =
                flux * walk.throughput() * rangeAttenuation(arrival.wayMeters, flight.rangeMeters);
            photon.towardOrigin = -flight.direction;
            photon.normal = at.normalGeometric;
            photon.triangle = hit.triangle;
            photon.backFace = hit.backFace;
            batch.photons.push_back(photon);
        }
        passes = walk.passes(hit);
    }
    if (arrival.hit && rays.glassOf(arrival.hit.triangle) == Glass::none) arrival.stored = false;
    flight.fluxWatts = flux * walk.throughput();
    return arrival;
}

void trace(const RayScene& rays, const EmittedPhoton& emitted, Rng rng, int maxBounces, Batch& batch) {
    Flight flight{emitted.origin, emitted.direction, emitted.fluxWatts, emitted.rangeMeters};
    const float fluxGoal = maxComponent(emitted.fluxWatts);
    for (int bounce = 0; maxComponent(flight.fluxWatts) > 0; ++bounce) {
        const glm::dvec3 before(flight.fluxWatts);
        Arrival arrival;
        if (rays.hasGlass()) {
            Photon photon;
            photon.firstHit = bounce == 0;
            photon.punctual = emitted.punctual;
            arrival = throughGlass(rays, rng.bits64(), photon, flight, batch);
        } else {
            arrival.hit = rays.closestHit(flight.origin, flight.direction);
            arrival.wayMeters = arrival.hit.distance;
        }
        const Hit& hit = arrival.hit;
        if (!hit) {
            batch.stats.absorbedWatts += before - glm::dvec3(flight.fluxWatts);
            batch.stats.escapedWatts += glm::dvec3(flight.fluxWatts);
            return;
        }
        flight.fluxWatts *= rangeAttenuation(arrival.wayMeters, flight.rangeMeters);
        bool goesOn = false;
        if (!isBlackSide(rays.scene(), hit) && maxComponent(flight.fluxWatts) > 0) {
            const SurfacePoint surface = surfaceAt(rays.scene(), hit, flight.direction);
            if (!arrival.stored)
                batch.photons.push_back({surface.position, flight.fluxWatts, -flight.direction,
                                         surface.normalGeometric, hit.triangle, bounce == 0, emitted.punctual,
                                         hit.backFace});
            goesOn = bounce < maxBounces && reflect(rays, surface, fluxGoal, rng, flight, batch.stats);
        }
        batch.stats.absorbedWatts += before - (goesOn ? glm::dvec3(flight.fluxWatts) : glm::dvec3(0));
        if (!goesOn) return;
    }
}

void addStats(PhotonStats& sum, const PhotonStats& more) {
    sum.stored += more.stored;
    sum.belowSurface += more.belowSurface;
    sum.emittedWatts += more.emittedWatts;
    sum.absorbedWatts += more.absorbedWatts;
    sum.escapedWatts += more.escapedWatts;
}

}  // namespace

PhotonMap tracePhotons(const RayScene& rays, const LightSampler& lights, const PhotonSettings& settings,
                       Progress& progress) {
    return tracePhotonPart(rays, lights, settings, 0, settings.count, progress);
}

PhotonMap tracePhotonPart(const RayScene& rays, const LightSampler& lights, const PhotonSettings& settings,
                          uint64_t begin, uint64_t end, Progress& progress) {
    assert(begin <= end && end <= settings.count);
    PhotonMap map;
    map.unitMeters = rays.unitMeters();
    if (!(maxComponent(lights.powerPunctual() + lights.powerArea()) > 0)) return map;

    progress.begin("photons", end - begin);
    std::vector<Batch> batches((end - begin + kBatchSize - 1) / kBatchSize);
    tbb::parallel_for(size_t(0), batches.size(), [&](size_t i) {
        progress.throwIfStopped();
        const uint64_t first = begin + i * kBatchSize, last = std::min(first + kBatchSize, end);
        Batch& batch = batches[i];
        for (uint64_t photon = first; photon < last; ++photon) {
            const EmittedPhoton emitted = lights.emitPhoton(photon, settings.count, settings.seed);
            batch.stats.emittedWatts += glm::dvec3(emitted.fluxWatts);
            trace(rays, emitted, Rng(hashOf(settings.seed, kBounceStream, photon)), settings.maxBounces,
                  batch);
        }
        batch.stats.stored = batch.photons.size();
        batch.photons.shrink_to_fit();
        progress.advance(last - first);
    });

    // In batch order, so that neither the photons nor the sums depend on who traced them.
    for (const Batch& batch : batches) addStats(map.stats, batch.stats);
    if (map.stats.stored > std::numeric_limits<uint32_t>::max()) throw std::length_error("too many photons");
    map.stats.emitted = end - begin;
    map.photons.reserve(map.stats.stored);
    for (Batch& batch : batches) {
        map.photons.insert(map.photons.end(), batch.photons.begin(), batch.photons.end());
        batch.photons = {};
    }
    progress.end();
    return map;
}

}  // namespace phat
