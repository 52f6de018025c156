#pragma once
// Rays that end in the irradiance of the texels themselves.

#include <optional>
#include <vector>

#include "core/bake/gather.h"

namespace phat {

inline constexpr uint32_t kNoTexel = ~0u;

/// Input of rays that end in texels.
struct TexelWorld {
    LitScene scene;
    const Atlas& atlas;
    const TexelPoints& points;
    const std::vector<uint8_t>& irradianceTexels;  // as GatherInput's
};

/// The receiving texel under a hit, or one beside it on the surface; none where the surface has no texels on
/// that side.
std::optional<uint32_t> texelOfHit(const TexelWorld& world, const Hit& hit);

/// Incident radiance along a ray without direct emission:
/// light + weight * indirect irradiance of `texel`.
struct IrradianceRay {
    glm::vec3 light{0};         // W/(m2 sr)
    uint32_t texel = kNoTexel;  // kNoTexel: `light` is all
    glm::vec3 weight{0};        // 1/sr
    float distance = kFarDistance;
};

/// Traces one ray. The diffuse part of its hit ends the path: shadow rays sample the punctual lights'
/// light, `areaIrradiance` (RGB9E5 [y][x] or empty) the area lights', and the texel the rest. The specular
/// part is followed, chosen in proportion to the albedos, through at most `maxBounces` reflections. Where a
/// hit has no texel, the diffuse part is followed, too.
IrradianceRay traceToTexels(const GatherInput& input, const std::vector<uint32_t>& areaIrradiance,
                            const Ray& ray, int maxBounces, Rng& rng, uint64_t& rayCount);

/// Irradiance of the texels, RGB9E5 [y][x], W/m2.
struct TexelIrradiance {
    const std::vector<uint32_t>& indirect;
    const std::vector<uint32_t>& area;  // may be empty
    /// Whether to interpolate between texels, for directly visible reflections; else the nearest texel.
    bool interpolated = false;
};

/// The surface that a ray met.
struct VisibleHit {
    const Hit& hit;
    const SurfacePoint& point;  // at `hit`
    glm::vec3 towardEye;        // back along the ray
};

/// Radiance that a surface reflects, W/(m2 sr).
struct HitReflection {
    /// By its glossy lobes, of all but punctual lights: the mean of walks, with their noise.
    glm::vec3 glossy{0};
    glm::vec3 rest{0};
    glm::vec3 glossyAlbedo{0};
    int walks = 0;
    float nearness = 0;  // mean over the walks of 1 / m to what they met first

    glm::vec3 sum() const { return glossy + rest; }
};

/// What the surface at a ray's hit reflects back along the ray: its diffuse part by the irradiance of the
/// texel there and by shadow rays to the punctual lights, its glossy part by `pathsPerHit` walks through
/// further glossy reflections until they end in a texel. Where there is no texel, by walks alone.
HitReflection reflectedFromTexels(const TexelWorld& world, const TexelIrradiance& irradiance,
                                  const VisibleHit& visible, const PathSettings& settings, Rng& rng,
                                  uint64_t& rayCount);

/// Incident radiance along a ray, as traceIncident estimates it, but with the irradiance of the texel that it
/// hits instead of diffuse paths (reflectedFromTexels). Emission is not looked for. What is nearer than
/// `nearMeters` gets more walks: fewer PHATexels contribute to the picture of it.
IncidentRadiance incidentFromTexels(const GatherInput& input, const TexelIrradiance& irradiance,
                                    const Ray& ray, const PathSettings& settings, float nearMeters, Rng rng);

}  // namespace phat
