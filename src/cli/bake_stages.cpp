#include "cli/bake_stages.h"

namespace phat {

std::vector<PlannedStage> bakeStages(const BakeSettings& settings) {
    std::vector<PlannedStage> stages = {{"photons", 1},      {"atlas", 1},      {"texels", 1},
                                        {"guides", 1},       {"directions", 1}, {"area light", 1},
                                        {"soft shadows", 1}, {"guides", 1}};
    for (int layer = 0; layer < settings.layers; ++layer) {
        stages.push_back({"directions", 1});
        stages.push_back({"indirect light", 1.0 * settings.pathsPerPhatexel});
    }
    stages.push_back({"compress", 1});
    return stages;
}

}  // namespace phat
