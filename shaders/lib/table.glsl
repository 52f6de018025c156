// One-dimensional tables in two-dimensional textures, because a texture's side is limited.
// twin: src/gl/textures.h, kTableWidth.

const int kTableWidth = 2048;

ivec2 tableTexel(int index) {
    return ivec2(index % kTableWidth, index / kTableWidth);
}
