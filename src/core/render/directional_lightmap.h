#pragma once

#include "core/atlas/atlas.h"
#include "core/phatexel/phatexture.h"
#include "core/render/irradiance_terms.h"

namespace phat {

/// Light of one kind that a bake has.
struct BakedSource {
    const std::vector<PhatexelLayer>& layers;
    const std::vector<Guide>& guides;
    const std::vector<uint32_t>& irradiance;  // RGB9E5; empty: none
};

/// Adds to `sum` the light of a source as its PHATexels say from where it comes, those of the texels that lie
/// around within kDirectionReach, else those of the chart's nearest texel with such; where there is none,
/// from everywhere alike. Scaled so that the irradiance of the texel's own normal is the map's.
void addDirections(const BakedSource& source, const Atlas& atlas, const TexelPoints& points,
                   IrradianceTerms& sum);
/// Adds terms that are scaled likewise. `light`: unscaled, of the same texels.
void addScaled(const IrradianceTerms& light, const std::vector<glm::vec3>& irradiance,
               const TexelPoints& points, IrradianceTerms& sum);

/// In texels to either side. Untuned: most of the weight is on a hundred texels or two, whose directions are
/// stratified together.
inline constexpr int kDirectionReach = 12;

}  // namespace phat
