// What is around the tiles of some blocks: the distance that a ray through each cell of their depth probes meets.
// twin: traceDepthProbe in src/core/phatexel/depth_probes.cpp.
#include "lib/atlas.glsl"
#include "lib/bvh.glsl"
#include "lib/hemisphere_map.glsl"
#include "lib/probe_codes.glsl"
#include "lib/ray_origin.glsl"
#include "lib/texel_point.glsl"
#include "lib/tile_patch.glsl"

uniform usampler2D tilePatches;

layout(location = 0) out uint codeOut;  // packDistance

const float kFar = 1e30;
const float kMinCosine = 0.01;  // no lobe looks below a texel's own horizon: such rays go along it

void main() {
    codeOut = kFarDistanceCode;
    BatchTile t = batchTileAt(ivec2(gl_FragCoord.xy), ivec2(kProbeCells));
    if (!t.valid) return;
    TilePatch on = tilePatchAt(tilePatches, t.tile, texelSizeOfTile(t.tile));
    TexelPoint point = texelPointAt((t.tile << kTileBits) + on.probeTexel);
    // Something may cover it that was not there when it was chosen.
    vec3 position = point.valid ? point.position : positionOnPatch(on, vec2(on.probeTexel) - 3.5);
    vec3 normal = point.valid ? point.normal : on.worldFromBlock[2];
    vec3 along = on.worldFromBlock * squareToHemisphere((vec2(t.inTile) + 0.5) / float(kProbeCells));
    vec3 above = normalize(along - min(dot(along, normal) - kMinCosine, 0.0) * normal);
    BvhHit hit = closestHit(offsetOrigin(position, normal, vec3(0.0)), above, kFar);
    if (hit.triangle >= 0) codeOut = packDistance(hit.distance);
}
