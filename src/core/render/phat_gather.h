#pragma once
// PHATextures evaluated in full, sample by sample, on the CPU: the best the data allow when time does not
// matter. source: Hensley et al. 2003, section 4.2; everything beyond its cone filter is ours
// (docs/reference.md).

#include "core/phatexel/phatexture.h"
#include "core/render/picture.h"
#include "core/scene/lights.h"

namespace phat {

/// Input of the renderer; must outlive it.
struct PhatGatherScene {
    const RayScene& rays;
    const LightSampler& lights;
    const Atlas& atlas;
    const TexelPoints& points;
    const Phatexture& phatexture;
};

struct PhatGatherSettings {
    /// > 0: the paper's filter, every PHATexel of the chart within this radius, taken as if it were at the
    /// visible point. 0: samples are reconnected to it, over a radius that follows the distance of what is
    /// reflected.
    float radiusMeters = 0;
    /// Test visibility of PHATexels' hits by rays, not by the neighbouring PHATexels.
    bool traceVisibility = false;
    Component component = Component::all;
};

/// Punctual lights by shadow rays, diffuse light from the irradiance maps, glossy light of the indirect and
/// of the area lights' PHATexels as the lobe's albedo times a mean of their radiances.
Integrator phatGather(const PhatGatherScene& scene, const PhatGatherSettings& settings);

}  // namespace phat
