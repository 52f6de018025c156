#pragma once
// Every light of a scene behind one interface: punctual, emissive triangles, environment.

#include <vector>

#include "core/random.h"
#include "core/rays.h"
#include "core/scene.h"
#include "core/shading.h"

namespace phat {

/// Light from one sampled place toward a receiving point.
struct LightSample {
    glm::vec3 towardLight{0};  // unit
    float distance = 0;        // metres; 1e30 for directional lights and the environment
    glm::vec3 radiance{0};     // delta lights: irradiance on a plane facing the light, W/m2; else W/(m2 sr)
    float pdf = 0;             // 1/sr; of a delta light, the probability of having chosen it; 0: no sample
    bool delta = false;
};

/// A photon as it leaves a light.
struct EmittedPhoton {
    glm::vec3 origin{0};
    glm::vec3 direction{0};    // the way it travels; unit
    glm::vec3 fluxWatts{0};    // already divided by the number of photons and the sampling density
    bool punctual = false;     // from a punctual light: its first hit is direct light of the run-time shader
};

/// Selection of lights by power, with densities that agree between sampling and hitting.
/// `rays.scene()` must outlive it.
class LightSampler {
  public:
    explicit LightSampler(const Scene& scene);

    bool empty() const;
    bool hasPunctual() const;
    /// Emissive triangles or environment: light that the bake, not the run-time shader, brings to surfaces.
    bool hasArea() const;

    /// Total emitted power in W by kind (environment and directional: through the scene's bounding sphere).
    glm::vec3 powerPunctual() const;
    glm::vec3 powerArea() const;

    /// A place on an area light or of the environment, seen from `point`. Visibility is the caller's.
    LightSample sampleArea(glm::vec3 point, float choice, glm::vec2 square) const;
    /// Density of sampleArea for having found, from `point`, the given hit on an emissive triangle.
    float sampleAreaPdf(glm::vec3 point, const Hit& hit, glm::vec3 direction) const;
    /// Density of sampleArea for the environment in `direction`.
    float sampleEnvironmentPdf(glm::vec3 direction) const;
    /// Radiance of the environment, 0 without one.
    glm::vec3 environmentRadiance(glm::vec3 direction) const;

    /// Irradiance (on a plane facing the light) of punctual light `index` at `point`; delta.
    LightSample samplePunctual(size_t index, glm::vec3 point) const;

    /// Photon `index` of `count`: stratified over lights by power. The sum of fluxWatts over all of them
    /// equals the lights' power (exactly for untextured ones, in expectation for the others).
    EmittedPhoton emitPhoton(uint64_t index, uint64_t count, uint64_t seed) const;

  private:
    // Owned by lights.cpp's author.
    const Scene* scene_;
};

}  // namespace phat
