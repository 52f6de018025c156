#include "core/render/lightmap.h"

#include <cassert>

#include "core/atlas/chart_fill.h"
#include "core/atlas/dilate.h"
#include "core/bake/irradiance.h"
#include "core/render/directional_lightmap.h"
#include "core/render/punctual_irradiance.h"

namespace phat {
namespace {

void addPacked(std::vector<glm::vec3>& sum, const std::vector<uint32_t>& packed) {
    assert(packed.empty() || packed.size() == sum.size());
    for (size_t i = 0; i < packed.size(); ++i) sum[i] += unpackRgb9e5(packed[i]);
}

// The texels that the bake's maps have values for: those that received light and the rings around them.
std::vector<uint8_t> filledTexels(const Atlas& atlas, const TexelPoints& points) {
    std::vector<uint8_t> known = irradianceTexels(atlas, points);
    std::vector<glm::vec3> values(known.size(), glm::vec3(0));
    fillWithinCharts(values, known, atlas, points);
    return known;
}

void addPunctual(const LightmapInput& input, Lightmap& lightmap, Progress& progress) {
    const LightSampler lights(input.scene);
    if (!lights.hasPunctual()) return;
    const RayScene rays(input.scene);
    std::optional<IrradianceTerms> terms;
    if (lightmap.byNormal) terms.emplace(input.atlas.texelCount());
    const std::vector<glm::vec3> irradiance =
        punctualIrradiance({rays, lights}, input.atlas, input.points, progress, terms ? &*terms : nullptr);
    for (size_t i = 0; i < irradiance.size(); ++i) lightmap.irradiance[i] += irradiance[i];
    if (terms) addScaled(*terms, irradiance, input.points, *lightmap.byNormal);
}

}  // namespace

Lightmap lightmapOf(const LightmapInput& input, LightmapLight light, bool byNormal, Progress& progress) {
    const auto& [scene, atlas, points, phatexture] = input;
    Lightmap lightmap;
    lightmap.irradiance.assign(atlas.texelCount(), glm::vec3(0));
    if (byNormal) lightmap.byNormal.emplace(atlas.texelCount());
    const auto add = [&](const BakedSource& source) {
        addPacked(lightmap.irradiance, source.irradiance);
        if (byNormal) addDirections(source, atlas, points, *lightmap.byNormal);
    };
    add({phatexture.indirect, phatexture.indirectGuides, phatexture.indirectIrradiance});
    if (light != LightmapLight::indirect)
        add({phatexture.area, phatexture.areaGuides, phatexture.areaIrradiance});
    if (light == LightmapLight::all) addPunctual(input, lightmap, progress);
    std::vector<uint8_t> known = filledTexels(atlas, points);
    dilateWithinCharts(lightmap.irradiance, known, atlas);
    // Texels without a place have no normal that terms could be scaled for.
    for (size_t i = 0; i < known.size(); ++i) known[i] = known[i] && points.triangle[i] != kNoTriangle;
    if (byNormal)
        for (std::vector<glm::vec3>& term : lightmap.byNormal->term) dilateWithinCharts(term, known, atlas);
    return lightmap;
}

}  // namespace phat
