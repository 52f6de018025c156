#pragma once
// Images from a photon map: the paper's two reference solutions.
// source: Hensley et al. 2003, section 5 and figure 6; Jensen 2001.

#include "core/render/picture.h"
#include "core/transport/photon_map.h"

namespace phat {

/// Input of the photon renderers; must outlive them.
struct PhotonScene {
    const RayScene& rays;
    const LightSampler& lights;
    const PhotonMap& photons;
    const PhotonIndex& index;
    const Scene* viewedScene =
        nullptr;  // materials where the eye meets a surface, as in pathTracer; null: the rays'
};

struct PhotonRendererSettings {
    DensityEstimate density;
    int gatherRays = 200;  // photonsGather: final gather rays a sample of a pixel
    Component component = Component::all;
};

/// The "approximate" solution: direct light by shadow rays, indirect light from the density of the reflected
/// photons around the visible point. Noise and blur are those of the k nearest photons.
Integrator photonsDirect(const PhotonScene& scene, const PhotonRendererSettings& settings);

/// The "exact" solution: direct light by shadow rays; indirect light by rays drawn from the visible point's
/// BRDF, with direct light by shadow rays and the photons' density where they hit. Blurred one bounce later,
/// where it is averaged over all rays.
Integrator photonsGather(const PhotonScene& scene, const PhotonRendererSettings& settings);

}  // namespace phat
