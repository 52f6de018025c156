#pragma once
// Settings of a bake: resolution, photons, directions and the source of radiance.

#include "core/atlas/atlas.h"
#include "core/phatexel/directions.h"
#include "core/transport/photon_map.h"

namespace phat {

/// Where the radiance of a PHATexel comes from.
enum class RadianceSource : uint8_t {
    texels,   // irradiance of the texels that the ray meets; glossy reflections on the way are followed
    path,     // paths from there, unbiased
    photons,  // the photons there: the paper's exact-solution analogue
    splat,    // the chosen photon itself: the paper's approximate analogue
};

struct BakeSettings {
    AtlasSettings atlas;
    PhotonSettings photons;
    DensityEstimate density;  // for RadianceSource::photons
    Directions directions = Directions::guided;
    RadianceSource radiance = RadianceSource::texels;
    int layers = 1;            // PHATexels per texel
    int pathsPerPhatexel = 8;  // RadianceSource::path, and texels on glossy surfaces
    int maxBounces = 256;  // of the longest path: white rooms need many, and between texels they cost no rays
    int irradianceSamples = 16;  // shadow rays a texel for area lights' diffuse part; four times in penumbrae
    uint64_t seed = 1;
    // For light that is not there yet: texels on all sides that it may reach, and an area layer without area
    // lights.
    bool dynamic = false;
};

}  // namespace phat
