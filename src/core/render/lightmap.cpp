#include "core/render/lightmap.h"

#include <cassert>

#include "core/atlas/chart_fill.h"
#include "core/atlas/dilate.h"
#include "core/bake/irradiance.h"
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

}  // namespace

std::vector<glm::vec3> lightmapOf(const LitScene& scene, const Atlas& atlas, const TexelPoints& points,
                                  const Phatexture& phatexture, LightmapLight light, Progress& progress) {
    std::vector<glm::vec3> irradiance(atlas.texelCount(), glm::vec3(0));
    addPacked(irradiance, phatexture.indirectIrradiance);
    if (light != LightmapLight::indirect) addPacked(irradiance, phatexture.areaIrradiance);
    if (light == LightmapLight::all && scene.lights.hasPunctual()) {
        const std::vector<glm::vec3> punctual = punctualIrradiance(scene, atlas, points, progress);
        for (size_t i = 0; i < irradiance.size(); ++i) irradiance[i] += punctual[i];
    }
    dilateWithinCharts(irradiance, filledTexels(atlas, points), atlas);
    return irradiance;
}

}  // namespace phat
