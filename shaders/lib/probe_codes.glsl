// Distances around tiles of some blocks, side by side in the target of a pass, before they are rounded to levels.
// twin: src/core/phatexel/depth_probes.cpp.
#include "lib/texel_batch.glsl"

const int kProbeCells = 16;  // per axis
const int kTileBits = 3;
const int kTilesOfBlock = 4;  // per axis
const uint kFarDistanceCode = 255u;

// A tile of a block whose part of a target has `texels` for it, and which of these `pixel` is.
struct BatchTile {
    bool valid;
    ivec2 tile;    // of the atlas
    ivec2 inTile;
    ivec2 corner;  // of its cells, where those of all tiles are side by side
};

BatchTile batchTileAt(ivec2 pixel, ivec2 texels) {
    ivec2 number = pixel / texels, slot = number / kTilesOfBlock, inBlock = number - kTilesOfBlock * slot;
    BatchBlock block = batchBlockAt(slot);
    return BatchTile(all(lessThan(inBlock << kTileBits, block.size)), (block.origin >> kTileBits) + inBlock,
                     pixel - texels * number, kProbeCells * number);
}
