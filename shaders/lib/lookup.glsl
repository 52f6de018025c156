// What arrives along a lobe: directions drawn from the BRDF, each answered by the PHATexel of a nearby block that
// looks there. ours, because averaging the neighbourhood instead reads thousands of texels a pixel for the same
// error (docs/pipeline.md, "Lookup").
// twin of the tables: src/core/lookup_tables.h, src/gl/lookup_pass.cpp.
#include "lib/atlas.glsl"
#include "lib/block_layout.glsl"
#include "lib/brdf.glsl"
#include "lib/frame.glsl"
#include "lib/phatexel.glsl"
#include "lib/visible_normal.glsl"

uniform usampler2D lookupTiles;     // [tileY][tileX], see LookupTile
uniform usampler2DArray phatexels;  // [layer][y][x] packed, 8 bytes
uniform sampler2D warps;            // a guide: uLow, uHigh, vLow, vHigh of each cell
uniform usampler2D probes;          // a probe: distance codes
uniform sampler2D texelPosition;    // world; zero where a texel has no surface
uniform sampler2D draws;            // [rank][k]: four uniform numbers a draw
uniform int guideCount;
uniform int drawCount;              // at most kMostDraws
#ifdef LAYERS
uniform usampler2D scrambles;       // [layer][block]
uniform int layerCount;
#endif

const int kMostDraws = 32;
const int kProbesAlongBlock = 4;
const int kProbeTexels = kBlockSize / kProbesAlongBlock;
const int kProbeSize = 16;
// Tables of 16x16 a guide or probe stand so many side by side.
const int kTablesWide = 512;

// The numbers below are the design study's, on one scene, unless a comment says more.
const int kTries = 3;               // places that a draw asks, each in half the radius of the one before
// And each expects the hit nearer: distance maps miss what is close. Smaller values show less of a glow at contacts,
// but darken: 1, .7 and .3 change gallery's mean brightness by -1.3, -1.4 and -1.8 %.
const float kCloser = 0.7;
const float kLeastTexels = 2.0;
const float kFewestTexels = 6.0;    // search radius: .7 of the distance, between these
const float kMostTexels = 128.0;
const float kFarther = 5.0;         // a sample that lies so many times farther than expected is behind something
const float kSlackMeters = 0.05;
// What is farther than this stands still while eye and block differ by metres.
const float kHorizonMeters = 1e4;
const float kNearMeters = 0.01;
// Samples that the neighbourhood must hold under a lobe. With fewer a sharp lobe shows single samples.
const float kWantedSamples = 8.0;
const float kMostWidening = 20.0;

struct LookupTile {
    uint chart;
    int block;
    ivec2 blockCorner;    // texel
    mat3 worldFromBlock;
    uint scramble;        // of layer 0
    float texelMeters;
    float chartTexels;    // how many texels its chart has
};

LookupTile lookupTileAt(ivec2 texel) {
    LookupTile t;
    t.chart = kNoChart;
    ivec2 tile = texel >> 3;
    if (any(lessThan(tile, ivec2(0))) || any(greaterThanEqual(tile, textureSize(lookupTiles, 0)))) return t;
    uvec4 bits = texelFetch(lookupTiles, tile, 0);
    if (bits.x == kNoChart) return t;
    t.chart = bits.x & 0x3fffffu;
    t.texelMeters = 1e-5 * exp2(float(bits.x >> 22) / 40.0);
    t.block = int(bits.y & 0xfffffffu);
    t.blockCorner = (tile - ivec2((bits.y >> 28) & 3u, bits.y >> 30)) * kTileSize;
    vec3 normal = unpackOctahedral24(bits.z & 0xffffffu);
    t.chartTexels = exp2(float(bits.z >> 24) / 8.0);
    float angle = float(bits.w & 0xfffu) * (2.0 * kPi / 4096.0);
    mat3 frame = frameFromNormal(normal);
    vec3 tangent = cos(angle) * frame[0] + sin(angle) * frame[1];
    t.worldFromBlock = mat3(tangent, cross(normal, tangent), normal);
    t.scramble = (bits.w >> 12) & 1023u;
    return t;
}

ivec2 tableCorner(int index) {
    return ivec2(index % kTablesWide, index / kTablesWide) * 16;
}

ivec2 hemisphereCell(vec3 direction, int size) {
    vec3 d = normalize(vec3(direction.xy, max(direction.z, 0.0)));
    return clamp(ivec2(hemisphereToSquare(d) * float(size)), 0, size - 1);
}

// A probe near the receiver: distances are as seen from its own place.
struct Probe {
    ivec2 corner;      // in `probes`
    vec3 offset;       // from the receiver to the probe, world
};

Probe probeNear(LookupTile tile, vec2 texel, vec3 position) {
    ivec2 place = (ivec2(floor(texel)) - tile.blockCorner) / kProbeTexels;
    int index = (tile.block * kProbesAlongBlock + place.y) * kProbesAlongBlock + place.x;
    vec3 at = texelFetch(texelPosition, tile.blockCorner + place * kProbeTexels + kProbeTexels / 2, 0).xyz;
    return Probe(tableCorner(index), at == vec3(0.0) ? vec3(0.0) : at - position);
}

// Metres from the receiver to what is seen along a unit direction.
float distanceAlong(Probe probe, mat3 worldFromBlock, vec3 direction) {
    uint code = texelFetch(probes, probe.corner + hemisphereCell(direction * worldFromBlock, kProbeSize), 0).r;
    return clamp(unpackDistance(code) + dot(probe.offset, direction), kNearMeters, kHorizonMeters);
}

vec4 warpAt(LookupTile tile, ivec2 cell) {
    return texelFetch(warps, tableCorner(guideCount == 1 ? 0 : tile.block) + cell, 0);
}

// 1/sr: the density that the block's directions were drawn from.
float warpDensity(vec4 warp) {
    return (warp.y - warp.x) * (warp.w - warp.z) * float(kGuideSize * kGuideSize) / (2.0 * kPi);
}

struct Lobe {
    vec3 normal;  // world
    float f0;
    float f90;
    float alpha;
};

float lobeValue(Lobe lobe, vec3 wo, vec3 wi) {
    vec3 h = normalize(wo + wi);
    return ggxD(h.z, lobe.alpha) * smithV(wi.z, wo.z, lobe.alpha) * wi.z *
           schlick(vec3(lobe.f0), lobe.f90, dot(wo, h)).x;
}

// Where light is asked for.
struct Receiver {
    vec3 position;
    vec3 towardEye;
    vec3 normalGeometric;
    vec2 texel;
    uint chart;
};

float searchRadius(float distance, float texelMeters) {
    return clamp(0.7 * distance / texelMeters, kFewestTexels, kMostTexels);
}

struct Found {
    bool valid;
    vec3 radiance;
    vec3 direction;  // seen from the receiver
    float spread2;   // square of the angle that may lie between the direction found and the one asked for
};

// The sample toward `wi`, where something is expected at distance `d`, of the block at `place`.
Found ask(Receiver r, vec2 place, vec3 wi, float d, int k) {
    Found found;
    found.valid = false;
    ivec2 q = ivec2(floor(place));
    LookupTile tile = lookupTileAt(q);
    if (tile.chart != r.chart) {
        // Mirrored at the chart's edge.
        q = ivec2(floor(2.0 * r.texel - place));
        tile = lookupTileAt(q);
        if (tile.chart != r.chart) return found;
    }
    // A group of 2^bits texels a side is small enough that its own parallax does not outweigh its cells' size.
    int bits = int(clamp(floor(0.5 * log2(3.6 * d / tile.texelMeters)), 2.0, float(kBlockBits)));
    int side = 1 << bits;
    ivec2 corner = tile.blockCorner + (((q - tile.blockCorner) >> bits) << bits);
    // Where the group's centre has no surface, the plane through the texel asked for stands in.
    vec3 center = texelFetch(texelPosition, corner + side / 2, 0).xyz;
    if (center == vec3(0.0)) {
        vec2 toCenter = vec2(corner) + 0.5 * float(side) - (vec2(q) + 0.5);
        center =
            texelFetch(texelPosition, q, 0).xyz + tile.texelMeters * (tile.worldFromBlock * vec3(toCenter, 0.0));
    }
    vec3 aim = normalize(r.position + wi * d - center) * tile.worldFromBlock;
    if (aim.z < 0.0) return found;

    vec2 scaled = hemisphereToSquare(aim) * float(kGuideSize);
    ivec2 cell = clamp(ivec2(scaled), 0, kGuideSize - 1);
    vec4 warp = warpAt(tile, cell);
    vec2 square = mix(warp.xz, warp.yw, clamp(scaled - vec2(cell), 0.0, 1.0));
#ifdef LAYERS
    int layer = k % layerCount;
    ivec2 entry = ivec2(tile.block % kTablesWide, (tile.block / kTablesWide) * layerCount + layer);
    uint scramble = texelFetch(scrambles, entry, 0).r;
#else
    const int layer = 0;
    uint scramble = tile.scramble;
#endif
    ivec2 texel = tile.blockCorner + texelHolding(square, corner - tile.blockCorner, bits, scramble);
    Phatexel phatexel = unpackPhatexel(texelFetch(phatexels, ivec3(texel, layer), 0).xy);
    if (!phatexel.valid) return found;

    vec3 hit = texelFetch(texelPosition, texel, 0).xyz +
               tile.worldFromBlock * phatexel.directionBlock * min(phatexel.distance, kHorizonMeters);
    float distance = max(length(hit - r.position), 1e-6);
    found.direction = (hit - r.position) / distance;
    found.radiance = phatexel.radiance;
    float cellAngle = 1.02 / float(side);
    float parallax = 0.408 * float(side) * tile.texelMeters / d;
    found.spread2 =
        cellAngle * cellAngle * clamp(1.0 / (2.0 * kPi * warpDensity(warp)), 0.05, 9.0) + parallax * parallax;
    found.valid = 2.0 * (1.0 - dot(found.direction, wi)) <= 4.0 * found.spread2 &&
                  distance <= kFarther * d + kSlackMeters;
    return found;
}

// A bias, named: a lobe under which the neighbourhood holds too few samples is drawn wider, because a blurred
// reflection disturbs less than the dots of single samples.
void widenLobe(inout Lobe lobe, LookupTile here, Probe probe, vec3 mirror, float cosine) {
    float reach = searchRadius(distanceAlong(probe, here.worldFromBlock, mirror), here.texelMeters);
    // The volume of the cone that places are drawn from, but no more texels than there are.
    float texels = min(kPi / 3.0 * reach * reach, here.chartTexels);
    float density = warpDensity(warpAt(here, hemisphereCell(mirror * here.worldFromBlock, kGuideSize)));
    // 1 / (integral of D^2) is 3 pi alpha^2 for small alpha, times d(light)/d(half) = 4 v.h.
    float solidAngle = min(12.0 * kPi * lobe.alpha * lobe.alpha * cosine, kPi);
    float widening = clamp(sqrt(kWantedSamples / max(texels * density * solidAngle, 1e-6)), 1.0, kMostWidening);
    lobe.alpha = min(lobe.alpha * widening, max(lobe.alpha, 1.0));
}

// sum g L, sum g over a pixel's draws with g = f cos / pdf: the ratio is what the lobe sees. `rank`: which
// sixteenth of the numbers is the pixel's own. The lobe returns as it was drawn.
vec4 lookUp(Receiver r, inout Lobe lobe, int rank) {
    mat3 worldFromLocal = frameFromNormal(lobe.normal);
    vec3 wo = r.towardEye * worldFromLocal;
    LookupTile here = lookupTileAt(ivec2(floor(r.texel)));
    if (wo.z <= 0.0 || here.chart != r.chart) return vec4(0.0);
    Probe probe = probeNear(here, r.texel, r.position);
    widenLobe(lobe, here, probe, worldFromLocal * vec3(-wo.xy, wo.z), wo.z);

    vec4 sum = vec4(0.0);
    for (int k = 0; k < drawCount; ++k) {
        vec4 u = texelFetch(draws, ivec2(k, rank), 0);
        vec3 wi = reflect(-wo, squareToVisibleNormal(u.xy, wo, lobe.alpha));
        vec3 wiWorld = worldFromLocal * wi;
        if (wi.z <= 0.0 || dot(wiWorld, r.normalGeometric) <= 0.0) continue;
        float d = distanceAlong(probe, here.worldFromBlock, wiWorld);
        float radius = searchRadius(d, here.texelMeters);
        for (int i = 0; i < kTries; ++i, radius = max(0.5 * radius, kLeastTexels), d *= kCloser) {
            Found found = ask(r, r.texel + radius * squareToCone(u.zw, float(i)), wiWorld, d, k);
            if (!found.valid) continue;
            vec3 w = found.direction * worldFromLocal;
            if (w.z <= 0.0) continue;
            // The sample's own pdf and the Jacobian cancel: cells hold equal shares of the density
            // (docs/pipeline.md).
            float g = lobeValue(lobe, wo, w) / smoothedLobePdf(wo, w, lobe.alpha, found.spread2);
            sum += g * vec4(found.radiance, 1.0);
            break;
        }
    }
    return sum;
}
