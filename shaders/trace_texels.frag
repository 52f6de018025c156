// One ray of each texel of some blocks, and what it hits: that of its PHATexel, or one for its irradiance.
#include "lib/atlas.glsl"
#include "lib/bvh.glsl"
#include "lib/guide_direction.glsl"
#include "lib/packed_rays.glsl"
#include "lib/random.glsl"
#include "lib/ray_origin.glsl"
#include "lib/texel_batch.glsl"
#include "lib/texel_point.glsl"
#include "lib/tile_patch.glsl"

uniform usampler2DArray phatexels;
uniform usampler2D tilePatches;
uniform int layer;       // of the PHATexels
uniform int firstGuide;  // of the layer's light
uniform int guideCount;
uniform int choice;      // of the direction, see below
uniform int seed;

layout(location = 0) out uvec4 hitOut;  // see lib/packed_rays.glsl
layout(location = 1) out uvec4 placeOut;
layout(location = 2) out uint codeOut;  // the direction as a PHATexel stores it; 0xffffffff: no ray

const int kStored = 0;   // the PHATexel's own, where it has one
const int kGuided = 1;   // another one by the block's guide
const int kDiffuse = 2;  // by the cosine, around the texel's normal
const float kFar = 1e30;
const uint kNoRay = 0xffffffffu;

vec3 unpackedDirection(uint code) {
    vec3 d = unpackOctahedral24(code);
    return vec3(d.xy, max(d.z, 0.0));
}

uint chosenCode(BatchTexel t) {
    uint bits = texelFetch(phatexels, ivec3(t.texel, layer), 0).y;
    if (choice == kStored && bits >> 24 != 0u) return bits & 0xffffffu;
    vec2 jitter = randomNumbers(uvec3(t.texel, seed)).xy;
    int guide = firstGuide + (guideCount == 1 ? 0 : t.block.block);
    return packOctahedral24(squareToGuide(guide, stratifiedSquare(t.inBlock, t.block.scramble, jitter)));
}

// Density cos / pi.
vec3 diffuseDirection(BatchTexel t, vec3 normal) {
    vec2 jitter = randomNumbers(uvec3(t.texel, seed)).xy;
    vec2 disk = squareToDisk(stratifiedSquare(t.inBlock, t.block.scramble, jitter));
    return frameFromNormal(normal) * vec3(disk, sqrt(max(1.0 - dot(disk, disk), 0.0)));
}

void main() {
    hitOut = placeOut = uvec4(0u);
    codeOut = kNoRay;
    BatchTexel t = batchTexelAt(ivec2(gl_FragCoord.xy));
    if (!t.valid) return;
    TexelPoint point = texelPointAt(t.texel);
    if (choice == kDiffuse ? !point.receives : !point.valid) return;
    vec3 direction;
    float pdf = kMaxPdf;
    uint code = 0u;
    if (choice == kDiffuse) {
        direction = diffuseDirection(t, point.normal);
        pdf = max(dot(direction, point.normal), 0.0) / kPi;
    } else {
        code = chosenCode(t);
        ivec2 tile = t.texel >> 3;
        mat3 worldFromBlock = tilePatchAt(tilePatches, tile, texelSizeOfTile(tile)).worldFromBlock;
        direction = normalize(worldFromBlock * unpackedDirection(code));
    }
    if (dot(direction, point.normal) <= 0.0 || dot(direction, point.flatNormal) <= 0.0) return;
    vec3 origin = offsetOrigin(point.position, point.flatNormal, vec3(0.0));
    BvhHit hit = closestHit(origin, direction, kFar);
    packRay(TracedRay(1, direction, vec3(1.0), 1.0, pdf, hit.triangle, hit.backFace, hit.barycentric, hit.distance,
                      origin + direction * hit.distance), hitOut, placeOut);
    codeOut = code;
}
