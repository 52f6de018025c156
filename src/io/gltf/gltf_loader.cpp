#include "io/gltf/gltf_loader.h"

#include "io/base/file_error.h"
#include "io/gltf/gltf_animations.h"
#include "io/gltf/gltf_flatten.h"
#include "io/gltf/gltf_images.h"
#include "io/gltf/gltf_lights_cameras.h"
#include "io/gltf/gltf_materials.h"

namespace phat {

LoadedScene loadGltf(GltfSource& source) {
    try {
        gltf::Notes notes;
        gltf::MemoryBudget budget(0);
        const gltf::Document document = gltf::checkedDocument(source, budget, notes);
        const std::vector<gltf::WorldNode> nodes = gltf::worldNodes(document.model(), notes);

        LoadedScene loaded;
        loaded.scene.materials = gltf::readMaterials(document, notes);
        gltf::loadImages(document, loaded.scene, budget,
                         notes);  // a normal map that is missing needs no tangents
        gltf::flattenMeshes(document, nodes, loaded.scene, budget, notes);
        gltf::readLightsAndCameras(document, nodes, loaded.scene, notes);
        gltf::readAnimations(document, nodes, loaded.scene, budget, notes);
        loaded.notes = gltf::linesOf(notes);
        return loaded;
    } catch (const gltf::Problem& problem) {
        throw FileError(source.path, gltf::printable(problem.what()));
    } catch (const std::bad_alloc&) {
        throw FileError(source.path, "not enough memory");
    }
}

LoadedScene loadGltf(const std::string& path) {
    GltfSource source = openGltf(path);
    return loadGltf(source);
}

}  // namespace phat
