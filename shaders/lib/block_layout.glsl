// Which texel of a block holds the sample of a point of its unit square, and which point a texel holds.
// twin: stratifiedSquare in src/core/phatexel/directions.h; tests/gl compares the two.

const int kBlockBits = 5;
const int kBlockSize = 1 << kBlockBits;

uint spreadBits(uint x) {
    x = (x | (x << 4)) & 0x10f0fu;
    x = (x | (x << 2)) & 0x33333u;
    return (x | (x << 1)) & 0x55555u;
}

// Every other bit, from the lowest on; 10 bits in.
uint gatherBits(uint x) {
    x &= 0x155u;
    x = (x | (x >> 1)) & 0x133u;
    x = (x | (x >> 2)) & 0x10fu;
    return (x | (x >> 4)) & 0x1fu;
}

uint reverse10(uint x) {
    x = ((x & 0x155u) << 1) | ((x >> 1) & 0x155u);
    return ((x & 0x3u) << 8) | ((x & 0xcu) << 4) | (x & 0x30u) | ((x >> 4) & 0xcu) | (x >> 8);
}

// The texel, in the block, of the aligned group of 2^bits texels a side at `corner` whose sample covers `square`.
ivec2 texelHolding(vec2 square, ivec2 corner, int bits, uint scramble) {
    uvec2 cell = min(uvec2(square * float(1 << bits)), uvec2((1 << bits) - 1));
    uint code = (spreadBits(cell.x) | (spreadBits(cell.y) << 1)) << uint(2 * (kBlockBits - bits));
    // The low bits belong to finer cells, which other groups' texels hold.
    uint finer = (1u << uint(2 * (kBlockBits - bits))) - 1u;
    uint morton = reverse10((code ^ scramble) & ~finer);
    return corner + ivec2(gatherBits(morton), gatherBits(morton >> 1));
}

// The point of the texel at `inBlock`; `jitter` in [0,1)^2 moves it within its cell.
vec2 stratifiedSquare(ivec2 inBlock, uint scramble, vec2 jitter) {
    uint code = reverse10(spreadBits(uint(inBlock.x)) | (spreadBits(uint(inBlock.y)) << 1)) ^ (scramble & 1023u);
    return (vec2(gatherBits(code), gatherBits(code >> 1)) + jitter) / float(kBlockSize);
}
