#include "cli/bake_stages.h"

namespace phat {

// The costs are microseconds of one core, measured on a room of 43,000 triangles and an atlas of 250,000
// texels. They need not be right on other machines and scenes, only in proportion.
std::vector<PlannedStage> bakeStages(const BakeSettings& settings, const ProbeSettings& probes) {
    // A texel size tells nothing of the number of texels before the surfaces are measured.
    const double texels = settings.atlas.texelSizeMeters > 0 ? 1e6 : double(settings.atlas.texelBudget);
    std::vector<PlannedStage> stages = {{"photons", 13.0 * double(settings.photons.count)},
                                        {"unwrap", 14 * texels},
                                        {"find occluded texels", 16 * texels},
                                        {"guides", 22 * texels},
                                        {"directions", 2 * texels},
                                        {"area light", 3 * texels},
                                        {"soft shadows", 17 * texels},
                                        {"diffuse light", 4 * texels},
                                        {"diffuse contacts", texels},
                                        {"diffuse contacts", texels},
                                        {"guides", 28 * texels}};
    const double indirect =
        settings.radiance == RadianceSource::path ? 12.0 * settings.pathsPerPhatexel : 8.0;
    for (int layer = 0; layer < settings.layers; ++layer) {
        stages.push_back({"directions", 2 * texels});
        stages.push_back({"indirect light", indirect * texels});
    }
    stages.push_back({"distances", 3 * texels});
    if (probes.count > 0) stages.push_back({"light probes", 4000.0 * probes.count});
    stages.push_back({"compress", 4 * texels * settings.layers});
    return stages;
}

}  // namespace phat
