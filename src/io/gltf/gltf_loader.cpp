#include "io/gltf/gltf_loader.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/atlas/divided_surfaces.h"
#include "core/atlas/expected_texel_size.h"
#include "io/base/file_error.h"
#include "io/base/printable.h"
#include "io/gltf/gltf_animations.h"
#include "io/gltf/gltf_divide.h"
#include "io/gltf/gltf_flatten.h"
#include "io/gltf/gltf_images.h"
#include "io/gltf/gltf_light_profiles.h"
#include "io/gltf/gltf_lights_cameras.h"
#include "io/gltf/gltf_materials.h"
#include "io/gltf/gltf_plain.h"
#include "io/gltf/gltf_unused.h"

namespace phat {

namespace {

using nlohmann::json;

void clearGeometry(Scene& scene) {
    scene.positions.clear();
    scene.normals.clear();
    scene.tangents.clear();
    scene.uv0.clear();
    scene.uv1.clear();
    scene.colors.clear();
    scene.triangles.clear();
    scene.triangleSurface.clear();
    scene.surfaces.clear();
}

// Divides surfaces in the file and reads all of them again.
void divideAtWalls(GltfSource& source, double texelSizeMeters, Scene& scene, gltf::MemoryBudget& budget) {
    const std::vector<DividedSurface> divided = divideAtWalls(RayScene(scene), texelSizeMeters);
    if (divided.empty()) return;
    gltf::dividePrimitives(source, scene, divided, budget);
    gltf::Notes sameAsBefore;
    const gltf::Document document = gltf::checkedDocument(source, budget, sameAsBefore);
    clearGeometry(scene);
    gltf::flattenMeshes(document, gltf::worldNodes(document.model(), sameAsBefore), scene, budget,
                        sameAsBefore);
}

LoadedScene loadPlain(GltfSource& source, const GltfLoadOptions& options, gltf::MemoryBudget budget) {
    gltf::Notes notes;
    gltf::makePlain(source, options.variant, budget, notes);
    const gltf::Document document = gltf::checkedDocument(source, budget, notes);
    const std::vector<gltf::WorldNode> nodes = gltf::worldNodes(document.model(), notes);

    LoadedScene loaded;
    loaded.scene.materials = gltf::readMaterials(document, notes);
    gltf::loadImages(document, loaded.scene, budget,
                     notes);  // a normal map that is missing needs no tangents
    gltf::flattenMeshes(document, nodes, loaded.scene, budget, notes);
    gltf::readLightsAndCameras(document, nodes, loaded.scene, budget, notes);
    gltf::attachPhotometries(options.photometries, source, loaded.scene);
    gltf::readAnimations(document, nodes, loaded.scene, budget, notes);
    if (options.divideFor) {
        loaded.wallTexelSizeMeters = options.wallTexelSizeMeters > 0
                                         ? options.wallTexelSizeMeters
                                         : expectedTexelSizeMeters(loaded.scene, *options.divideFor);
        divideAtWalls(source, loaded.wallTexelSizeMeters, loaded.scene, budget);
    }
    loaded.notes = gltf::linesOf(notes);
    return loaded;
}

std::string reasonOf(const std::exception& error) {
    if (dynamic_cast<const json::exception*>(&error))
        return fmt::format("its JSON is not what glTF asks for ({})", error.what());
    return error.what();
}

// A file that is refused gets a second chance without what its scene does not need. That is only then looked
// at: other files keep all that they have.
LoadedScene loadTolerantly(GltfSource& source, const GltfLoadOptions& options) {
    gltf::MemoryBudget budget(0);
    budget.allowFor(source.fileBytes);
    gltf::readBuffers(source, budget);
    const json original = source.json;
    const size_t bufferCount = source.buffers.size();
    std::string refusal;
    try {
        return loadPlain(source, options, budget);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        refusal = reasonOf(error);
    }
    source.json = original;
    source.buffers.resize(bufferCount);
    try {
        if (!gltf::leaveOutUnused(source)) throw gltf::Problem(refusal);
    } catch (const json::exception&) {
        throw gltf::Problem(refusal);  // the first reason is the plainer one
    }
    LoadedScene loaded = loadPlain(source, options, budget);
    const std::string note =
        fmt::format("what the scene does not use is left out, because some of it is broken: {}", refusal);
    loaded.notes.insert(loaded.notes.begin(), printable(note, gltf::kShownBytes));
    return loaded;
}

}  // namespace

LoadedScene loadGltf(GltfSource& source, const GltfLoadOptions& options) {
    try {
        return loadTolerantly(source, options);
    } catch (const std::bad_alloc&) {
        throw FileError(source.path, "not enough memory");
    } catch (const std::exception& error) {
        throw FileError(source.path, printable(reasonOf(error), gltf::kShownBytes));
    }
}

LoadedScene loadGltf(const std::string& path) {
    GltfSource source = openGltf(path);
    return loadGltf(source);
}

}  // namespace phat
