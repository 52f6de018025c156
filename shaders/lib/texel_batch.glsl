// Texels whose light is made anew: blocks of the atlas, side by side in the target of a pass.
// twin: src/gl/light_update_pass.cpp.
#include "lib/block_layout.glsl"

const int kBatchSide = 8;  // blocks

uniform uvec4 batchBlocks[kBatchSide * kBatchSide];  // origin, size (y << 16 | x, texels), block, maxSamples << 16 | scramble

struct BatchBlock {
    ivec2 origin, size;  // texels of the atlas
    int block;
    uint scramble;       // of its layout, see stratifiedSquare
    float maxSamples;    // that what is known so far counts as
};

BatchBlock batchBlockAt(ivec2 slot) {
    uvec4 entry = batchBlocks[slot.y * kBatchSide + slot.x];
    return BatchBlock(ivec2(entry.x & 0xffffu, entry.x >> 16), ivec2(entry.y & 0xffffu, entry.y >> 16), int(entry.z),
                      entry.w & 0xffffu, float(entry.w >> 16));
}

struct BatchTexel {
    bool valid;
    ivec2 texel;  // of the atlas
    ivec2 inBlock;
    BatchBlock block;
};

BatchTexel batchTexelAt(ivec2 pixel) {
    BatchBlock block = batchBlockAt(pixel >> kBlockBits);
    ivec2 inBlock = pixel & (kBlockSize - 1);
    return BatchTexel(all(lessThan(inBlock, block.size)), block.origin + inBlock, inBlock, block);
}
