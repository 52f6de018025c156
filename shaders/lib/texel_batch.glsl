// Texels whose light is made anew: blocks of the atlas, side by side in the target of a pass.
// twin: src/gl/light_update_pass.cpp.
#include "lib/block_layout.glsl"

const int kBatchSide = 8;  // blocks

uniform uvec4 batchBlocks[kBatchSide * kBatchSide];  // origin, size (y << 16 | x, texels), block, maxSamples << 16 | scramble

struct BatchTexel {
    bool valid;
    ivec2 texel;        // of the atlas
    ivec2 inBlock;
    int block;
    uint scramble;      // of the block's layout, see stratifiedSquare
    float maxSamples;  // that the irradiance so far counts as
};

BatchTexel batchTexelAt(ivec2 pixel) {
    ivec2 slot = pixel >> kBlockBits, inBlock = pixel & (kBlockSize - 1);
    uvec4 entry = batchBlocks[slot.y * kBatchSide + slot.x];
    ivec2 size = ivec2(entry.y & 0xffffu, entry.y >> 16);
    return BatchTexel(all(lessThan(inBlock, size)), ivec2(entry.x & 0xffffu, entry.x >> 16) + inBlock, inBlock,
                      int(entry.z), entry.w & 0xffffu, float(entry.w >> 16));
}
