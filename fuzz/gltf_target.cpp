#include "expect.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_loader.h"
#include "io/gltf/gltf_source.h"
#include "scene_promises.h"
#include "scratch_file.h"
#include "targets.h"

namespace phat::fuzz {

void gltf(Bytes bytes) {
    const ScratchFile file(bytes, "scene.glb");
    try {
        GltfSource source = openGltf(file.path());
        const Scene scene = loadGltf(source).scene;
        expectConsistent(scene);
        // Who writes a baked file finds the way back from each triangle.
        for (const Surface& surface : scene.surfaces)
            expect(surfaceCorners(source, scene, surface).vertices.size() == surface.triangleCount,
                   "corners of all triangles");
    } catch (const FileError&) {
    }
}

}  // namespace phat::fuzz
