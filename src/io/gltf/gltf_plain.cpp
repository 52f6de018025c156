#include "io/gltf/gltf_plain.h"

namespace phat::gltf {

void makePlain(GltfSource& source, const std::string& variant, MemoryBudget& budget, Notes& notes) {
    mendLightsAndCameras(source.json, notes);
    takeBasisFallbacks(source.json, notes);
    decodeMeshopt(source, budget);
    decodeDraco(source, budget);
    chooseVariant(source.json, variant);
    convertSpecularGlossiness(source, budget, notes);
    expandInstances(source, budget);
    applyPose(source, budget, notes);
}

}  // namespace phat::gltf
