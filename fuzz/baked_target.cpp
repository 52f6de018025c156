#include "expect.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_source.h"
#include "io/phat/baked_file.h"
#include "io/phat/web_parts.h"
#include "scene_promises.h"
#include "scratch_file.h"
#include "targets.h"

namespace phat::fuzz {
namespace {

void expectConsistent(const BakedScene& baked) {
    fuzz::expectConsistent(baked.loaded.scene);
    const Atlas& atlas = baked.atlas;
    const size_t texels = atlas.texelCount();
    expect(blockFrames(atlas, baked.points).size() == atlas.blockCount, "a frame for every block");
    expect(atlas.tileChart.size() * kTileSize * kTileSize == texels, "a chart, or none, for every tile");
    expect(baked.points.state.size() == texels, "a state for every texel");
    for (const auto* layers : {&baked.phatexture.indirect, &baked.phatexture.area})
        for (const PhatexelLayer& layer : *layers)
            expect(layer.texels.size() == texels, "a PHATexel for every texel");
    expect(baked.phatexture.tilePatches.size() == atlas.tileChart.size(), "a place for every tile");
}

}  // namespace

void baked(Bytes bytes) {
    const ScratchFile file(bytes, "room.phat.glb");
    try {
        if (!isBakedFile(file.path())) return;
        expectConsistent(readBakedFile(file.path()));
        GltfSource source = openGltf(file.path());
        splitForWeb(source, "room");
    } catch (const FileError&) {
    }
}

}  // namespace phat::fuzz
