#pragma once
// Irradiance of area lights at many positions, without the rays whose outcome is known.

#include "core/transport/path.h"

namespace phat {

/// Boxes around everything of a scene that shines.
class ShiningBounds {
  public:
    explicit ShiningBounds(const RayScene& rays);

    /// False only where the straight way along the ray, endless and through everything, meets nothing that
    /// shines.
    bool mayMeet(const Ray& ray) const;

  private:
    std::vector<Bounds> boxes_;
    bool anywhere_ = false;
};

/// Which light samples of an estimate have a shadow ray.
enum class ShadowRays : uint8_t {
    all,
    /// One in kSparseShadowRays, at random. The others count as seen, and a traced one that is in shadow
    /// takes away what it and those that it stands for would have brought: the same expected value, wherever
    /// the shadows are, and no noise of the choice where there are none.
    sparse,
};
inline constexpr int kSparseShadowRays = 4;

/// areaIrradiance of one scene, which must outlive it.
class AreaIrradianceSampler {
  public:
    explicit AreaIrradianceSampler(const LitScene& scene) : scene_(scene), shining_(scene.rays) {}

    /// As the function of this name, which traces ShadowRays::all.
    IrradianceEstimate areaIrradiance(glm::vec3 position, glm::vec3 normal,
                                      const IrradianceSampling& sampling, ShadowRays shadowRays, Rng rng,
                                      uint64_t& rayCount) const;

  private:
    struct Round;
    struct Receiver;
    void addLightSamples(const Receiver& at, int firstTraced, Rng& rng, Round& round) const;
    void addCosineSamples(const Receiver& at, Rng& rng, Round& round) const;

    LitScene scene_;
    ShiningBounds shining_;
};

}  // namespace phat
