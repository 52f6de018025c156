// The bounds of the radiance that arrives around tiles, of PHATexels that the GPU has made: the brightest within three tiles,
// as far as the widest cone reaches. First those of each tile, then of its neighbourhood.
// twin: tileLight in src/core/phatexel/radiance_bound.cpp, where light of both sources adds up only if emitters reflect.
#include "lib/atlas.glsl"

#ifdef FIRST
#include "lib/phatexel.glsl"

uniform usampler2DArray phatexels;  // [layer][y][x], those of indirect light first
uniform int layerCount;             // of indirect light

layout(location = 0) out vec4 indirectOut;
layout(location = 1) out vec4 areaOut;

vec3 brightestOfLayer(ivec2 corner, int layer) {
    vec3 brightest = vec3(0.0);
    for (int i = 0; i < kTileSize * kTileSize; ++i) {
        ivec2 texel = corner + ivec2(i % kTileSize, i / kTileSize);
        brightest = max(brightest, unpackPhatexel(texelFetch(phatexels, ivec3(texel, layer), 0).xy).radiance);
    }
    return brightest;
}

void main() {
    ivec2 corner = kTileSize * ivec2(gl_FragCoord.xy);
    vec3 brightest[2] = vec3[2](vec3(0.0), vec3(0.0));
    for (int layer = 0; layer < textureSize(phatexels, 0).z; ++layer) {
        int source = layer < layerCount ? 0 : 1;
        brightest[source] = max(brightest[source], brightestOfLayer(corner, layer));
    }
    indirectOut = vec4(brightest[0], 0.0);
    areaOut = vec4(brightest[1], 0.0);
}
#else
uniform sampler2D indirect;  // see above
uniform sampler2D area;
uniform vec3 brightest;      // radiance that nothing exceeds

layout(location = 0) out vec4 boundOut;  // its alpha is not written

// twin: src/core/phatexel/radiance_bound.cpp.
const int kNeighborTiles = 3;

void main() {
    ivec2 tile = ivec2(gl_FragCoord.xy);
    uint chart = chartOfTile(tile);
    vec3 indirectAround = vec3(0.0), areaAround = vec3(0.0);
    for (int y = -kNeighborTiles; y <= kNeighborTiles; ++y)
        for (int x = -kNeighborTiles; x <= kNeighborTiles; ++x) {
            ivec2 neighbor = tile + ivec2(x, y);
            if (chart == kNoChart || chartOfTile(neighbor) != chart) continue;
            indirectAround = max(indirectAround, texelFetch(indirect, neighbor, 0).rgb);
            areaAround = max(areaAround, texelFetch(area, neighbor, 0).rgb);
        }
    boundOut = vec4(min(indirectAround + areaAround, brightest), 0.0);
}
#endif
