#pragma once
// Every light of a scene behind one interface: punctual, emissive triangles, environment.

#include <optional>
#include <vector>

#include "core/base/discrete_distribution.h"
#include "core/base/random.h"
#include "core/scene/environment_sampling.h"
#include "core/scene/light_emitters.h"
#include "core/scene/rays.h"
#include "core/scene/scene.h"
#include "core/scene/shading.h"

namespace phat {

/// Light from one sampled point toward a receiver.
struct LightSample {
    glm::vec3 towardLight{0};  // unit
    float distance = 0;        // metres; 1e30 for directional lights and the environment
    glm::vec3 radiance{0};     // delta lights: irradiance on a plane facing the light, W/m2; else W/(m2 sr)
    float pdf = 0;             // 1/sr; of a delta light, the probability of having chosen it; 0: no sample
    bool delta = false;
    uint32_t triangle = ~0u;  // that shines; ~0u: none
};

/// A photon as it leaves a light.
struct EmittedPhoton {
    glm::vec3 origin{0};
    glm::vec3 direction{0};  // of propagation; unit
    glm::vec3 fluxWatts{0};  // already divided by the number of photons and the sampling density
    float rangeMeters = 0;   // 0: unlimited; else its first hit receives rangeAttenuation of the flux
    bool punctual = false;   // from a punctual light: its first hit is direct light of the run-time shader
};

/// Selection of lights by power, with densities that agree between sampling and hitting.
/// `scene` must outlive it.
class LightSampler {
  public:
    explicit LightSampler(const Scene& scene) : LightSampler(scene, scene.environment) {}
    /// The same with another environment than the scene's.
    LightSampler(const Scene& scene, SharedValue<Environment> environment);

    bool empty() const;
    bool hasPunctual() const;
    /// Directional lights that are discs: samplePunctual asks for a point of them.
    bool hasDiscs() const { return hasDiscs_; }
    /// Emissive triangles or environment: light that the bake, not the run-time shader, brings to surfaces.
    bool hasArea() const;

    /// Total emitted power in W by kind (environment and directional: through the scene's bounding sphere;
    /// lights of limited range: as if it were unlimited).
    glm::vec3 powerPunctual() const;
    glm::vec3 powerArea() const;

    /// Samples a point of an area light or a direction of the environment, as visible from `point`.
    /// Visibility is the caller's.
    LightSample sampleArea(glm::vec3 point, float choice, glm::vec2 square) const;
    /// Density with which sampleArea from `point` samples the given hit on an emissive triangle.
    float sampleAreaPdf(glm::vec3 point, const Hit& hit, glm::vec3 direction) const;
    /// Density of sampleArea for the environment in `direction`.
    float sampleEnvironmentPdf(glm::vec3 direction) const;
    /// Radiance of the environment, 0 without one.
    glm::vec3 environmentRadiance(glm::vec3 direction) const;

    /// Irradiance (on a plane facing the light) of punctual light `index` at `point`; delta, pdf 1.
    /// No sample (pdf 0) at the light itself and beyond its cone or range. `square`: of a light that is a
    /// disc, the point on it; the irradiance is that of all of the disc. Visibility is the caller's.
    LightSample samplePunctual(size_t index, glm::vec3 point, glm::vec2 square = glm::vec2(0)) const;

    /// Photon `index` of `count`: systematic over lights by power, low-discrepancy within each. The sum of
    /// fluxWatts over all of them equals the lights' power: exactly for untextured lights that are due at
    /// least one photon, in expectation for the others.
    EmittedPhoton emitPhoton(uint64_t index, uint64_t count, uint64_t seed) const;

  private:
    /// A source that photons are allotted to: a punctual light, a surface's emissive triangles, the
    /// environment.
    struct PhotonSource {
        enum class Kind : uint8_t { punctual, triangles, environment };
        Kind kind;
        uint32_t first = 0;  // light, or first emitter
        uint32_t end = 0;    // past the last emitter
    };
    struct PhotonTurn;  // which of its source's photons one is

    void addPhotonSources();
    PhotonTurn turnOf(uint64_t index, uint64_t count, uint64_t seed) const;
    EmittedPhoton fromPunctual(const PhotonSource& source, const PhotonTurn& turn) const;
    EmittedPhoton fromTriangles(const PhotonSource& source, const PhotonTurn& turn) const;
    EmittedPhoton fromEnvironment(const PhotonTurn& turn) const;

    const Scene* scene_;
    SharedValue<Environment> sky_;
    glm::vec3 sceneCenter_{0};
    float sceneRadius_ = 0;  // metres, of the sphere around the scene's bounds
    bool hasDiscs_ = false;
    float unitMeters_ = 1;  // lengthUnit() of the scene
    glm::vec3 powerPunctual_{0};
    glm::vec3 powerArea_{0};

    std::vector<EmissiveTriangle> emitters_;
    std::vector<uint32_t>
        emitterOfTriangle_;               // [triangle], kNoTriangle: does not shine; empty without emitters
    DiscreteDistribution emitterChoice_;  // by luminous power
    std::optional<EnvironmentDistribution> environment_;
    float environmentChance_ = 0;  // of sampleArea

    std::vector<PhotonSource> sources_;
    DiscreteDistribution sourceChoice_;  // by luminous power
};

}  // namespace phat
