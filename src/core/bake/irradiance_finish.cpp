#include "core/bake/irradiance_finish.h"

#include "core/phatexel/phatexture.h"

namespace phat {
namespace {

// Indirect irradiance is smoothed over up to 32 texels, and at borders from one side: where the charts of a
// curved surface disagree, they do so over some texels. With 6 the changes reach too far.
constexpr float kIndirectSpreadTexels = 3;

std::vector<uint32_t> packIrradiance(const IrradianceMap& map) {
    std::vector<uint32_t> packed;
    packed.reserve(map.size());
    for (const glm::vec3 value : map) packed.push_back(packRgb9e5(value));
    return packed;
}

}  // namespace

std::vector<uint32_t> finishAreaIrradiance(IrradianceMap irradiance, const GatherInput& input,
                                           const std::vector<SeamPoint>& seams, const Progress& progress) {
    stitchSeams(irradiance, seams, input.receivers(), 0, progress);
    return packIrradiance(irradiance);
}

std::vector<uint32_t> finishIndirectIrradiance(IrradianceMap irradiance, const GatherInput& input,
                                               const std::vector<SeamPoint>& seams,
                                               const Progress& progress) {
    stitchSeams(irradiance, seams, input.receivers(), kIndirectSpreadTexels, progress);
    return packIrradiance(irradiance);
}

}  // namespace phat
