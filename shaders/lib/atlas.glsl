// Which chart and which block an atlas texel belongs to.
// twin: Atlas::chartAt and Atlas::blockAt in src/core/atlas/atlas.h.

const int kTileSize = 8;
const uint kNoChart = 0xffffffffu;

// [tileY][tileX]: x chart, y block, both kNoChart where the atlas is empty; z the bits of the chart's texel size,
// metres. Outside of it, empty too.
uniform usampler2D tileTable;

uint chartOfTile(ivec2 tile) {
    if (any(lessThan(tile, ivec2(0))) || any(greaterThanEqual(tile, textureSize(tileTable, 0)))) return kNoChart;
    return texelFetch(tileTable, tile, 0).x;
}

// pre: the tile has a chart.
float texelSizeOfTile(ivec2 tile) {
    return uintBitsToFloat(texelFetch(tileTable, tile, 0).z);
}

uint chartAt(ivec2 texel) {
    return chartOfTile(ivec2(texel.x >> 3, texel.y >> 3));
}
