// What arrives along a lobe: directions drawn from the BRDF, each answered by the PHATexel of a nearby block that
// looks there. ours, because averaging the neighbourhood instead reads thousands of texels a pixel for the same
// error (docs/pipeline.md, "Lookup").
// twin of the tables: src/core/lookup_tables.h, src/core/distance_probes.h, src/gl/lookup_pass.cpp.
#include "lib/atlas.glsl"
#include "lib/block_layout.glsl"
#include "lib/brdf.glsl"
#include "lib/fetch.glsl"
#include "lib/frame.glsl"
#include "lib/phatexel.glsl"
#include "lib/table.glsl"
#include "lib/tile_patch.glsl"
#include "lib/visible_normal.glsl"

const int kMostDraws = 32;
const int kRanks = 16;

uniform usampler2D charts;          // see GpuAtlas::charts
uniform usampler2D tilePatches;     // see lib/tile_patch.glsl
uniform usampler2DArray phatexels;  // [layer][y][x] packed, 8 bytes
uniform sampler2D warps;            // a guide: uLow, uHigh, vLow, vHigh of each cell
uniform usampler2D probes;          // [4 tileY][2 tileX]: 8x4 levels of distance, 4 bits each
uniform uvec4 draws[kMostDraws];    // fractions of 2^32, the same for all pixels but for `ranks`
uniform uvec4 ranks[kRanks];
uniform int guideCount;
uniform int drawCount;              // at most kMostDraws
#ifdef LAYERS
uniform usampler2D scrambles;       // [layer][block]
uniform int layerCount;
#endif

const int kProbeSize = 16;
// Tables of 16x16 a guide stand so many side by side.
const int kTablesWide = 512;

// The numbers below are the design study's, on one scene, unless a comment says more.
const int kTries = 4;               // places that a draw asks, each in half the radius of the one before
const int kAimedTries = 3;          // of these, and each expects the hit nearer
const float kCloser = 0.7;
// The last one does not aim: a group of 2^kNearBits texels a side, within kNearTexels, answers as if it were the
// pixel. A draw that drops out would be a bias toward what is easy to find.
const int kNearBits = 3;
const float kNearTexels = 4.0;
const float kLeastTexels = 2.0;
const float kFewestTexels = 6.0;    // search radius: .7 of the distance, between these
const float kMostTexels = 128.0;
const float kFarther = 5.0;         // a sample that lies so many times farther than expected is behind something
// Radians between a sample's own direction and the one it gets when it is reconnected: what it saw of a glossy thing
// holds near its own direction alone.
const float kMostTurn = 0.5;
const float kSlackMeters = 0.05;
// What is farther than this stands still while eye and block differ by metres.
const float kHorizonMeters = 1e4;
const float kNearMeters = 0.01;
// Samples that the neighbourhood must hold under a lobe. With fewer a sharp lobe shows single samples; more widen lobes
// at contacts, where places are drawn from a small one, until they see bright things far off; what does not aim has more
// around it there (docs/pipeline.md).
const float kWantedSamples = 2.0;
const float kLeastReachTexels = 16.0;
const float kMostWidening = 20.0;

struct ChartPlace {
    ivec2 origin;  // texels
    ivec2 size;
    int firstBlock;
    float texelMeters;
};

ChartPlace chartPlace(uint chart) {
    uvec4 bits = READ(texelFetch(charts, tableTexel(int(chart)), 0));
    ivec2 origin = ivec2(bits.x & 0xffffu, bits.x >> 16) * 8;
    ivec2 size = ivec2(bits.y & 0xffffu, bits.y >> 16) * 8;
    return ChartPlace(origin, size, int(bits.z), uintBitsToFloat(bits.w));
}

int blockOf(ChartPlace chart, ivec2 texel) {
    ivec2 place = (texel - chart.origin) >> kBlockBits;
    int blocksWide = (chart.size.x + kBlockSize - 1) >> kBlockBits;
    return chart.firstBlock + place.y * blocksWide + place.x;
}

// A tile and where it stands in its block.
struct LookupTile {
    TilePatch tilePatch;
    int block;
    ivec2 blockCorner;  // texels
    vec2 middle;
};

LookupTile lookupTileAt(ChartPlace chart, ivec2 texel) {
    LookupTile t;
    ivec2 tile = texel >> 3;
    t.tilePatch = tilePatchAt(tilePatches, tile, chart.texelMeters);
    t.block = blockOf(chart, texel);
    t.blockCorner = chart.origin + (((texel - chart.origin) >> kBlockBits) << kBlockBits);
    t.middle = vec2(8 * tile + 4);
    return t;
}

ivec2 hemisphereCell(vec3 direction, int size) {
    vec3 d = normalize(vec3(direction.xy, max(direction.z, 0.0)));
    return clamp(ivec2(hemisphereToSquare(d) * float(size)), 0, size - 1);
}

// Distances around the receiver's tile, as seen from one of its texels; the last read is kept.
struct Probe {
    ivec2 corner;      // in `probes`
    vec2 range;        // metres
    vec3 offset;       // from the receiver to that texel, world
    ivec2 group;
    uvec4 levels;
};

Probe probeAt(LookupTile tile, ivec2 texel, vec3 position) {
    vec2 fromMiddle = vec2(tile.tilePatch.probeTexel) - 3.5;
    vec3 offset = tile.tilePatch.empty ? vec3(0.0) : placeOf(tile.tilePatch, fromMiddle) - position;
    return Probe((texel >> 3) * ivec2(2, 4), tile.tilePatch.probeRange, offset, ivec2(-1), uvec4(0u));
}

// twin: probeDistance in src/core/distance_probes.h.
float levelDistance(vec2 range, uint level) {
    return level == 15u ? kFarDistance : range.x * pow(range.y / range.x, float(level) / 14.0);
}

// Metres from the receiver to what is seen along a unit direction.
float distanceAlong(inout Probe probe, mat3 worldFromBlock, vec3 direction) {
    ivec2 cell = hemisphereCell(direction * worldFromBlock, kProbeSize);
    ivec2 group = ivec2(cell.x >> 3, cell.y >> 2);
    if (group != probe.group) {
        probe.levels = READ(texelFetch(probes, probe.corner + group, 0));
        probe.group = group;
    }
    uint level = (probe.levels[cell.y & 3] >> uint(4 * (cell.x & 7))) & 15u;
    return clamp(levelDistance(probe.range, level) + dot(probe.offset, direction), kNearMeters, kHorizonMeters);
}

vec4 warpAt(int block, ivec2 cell) {
    int guide = guideCount == 1 ? 0 : block;
    return READ(texelFetch(warps, ivec2(guide % kTablesWide, guide / kTablesWide) * kGuideSize + cell, 0));
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

// A texel of the chart near `place`; beyond the chart's edge, mirrored at `around` while that is inside.
ivec2 texelInChart(ChartPlace chart, vec2 place, vec2 around) {
    vec2 low = vec2(chart.origin), high = low + vec2(chart.size);
    if (any(lessThan(place, low)) || any(greaterThanEqual(place, high))) place = 2.0 * around - place;
    return clamp(ivec2(floor(place)), chart.origin, chart.origin + chart.size - 1);
}

struct Found {
    bool valid;
    vec3 radiance;
    vec3 direction;  // seen from the receiver
    float distance;
    float spread2;   // square of the angle that may lie between the direction found and the one asked for
};

// The sample toward `wi`, where something is expected at distance `d`, of the block around texel `q` of `tile`.
// `aimed`: toward the expected place, and reconnected to the receiver; else as if `q` were the receiver.
Found ask(Receiver r, ChartPlace chart, LookupTile tile, ivec2 q, vec3 wi, float d, bool aimed, int k) {
    Found found;
    found.valid = false;
    found.distance = 0.0;
    // A group of 2^bits texels a side is small enough that its own parallax does not outweigh its cells' size.
    int bits = int(clamp(floor(0.5 * log2(3.6 * d / chart.texelMeters)), 2.0, float(kBlockBits)));
    if (!aimed) bits = kNearBits;
    int side = 1 << bits;
    ivec2 corner = tile.blockCorner + (((q - tile.blockCorner) >> bits) << bits);
    vec3 center = placeOf(tile.tilePatch, vec2(corner) + 0.5 * float(side) - tile.middle);
    vec3 aim = (aimed ? normalize(r.position + wi * d - center) : wi) * tile.tilePatch.worldFromBlock;
    if (aim.z < 0.0) return found;

    vec2 scaled = hemisphereToSquare(aim) * float(kGuideSize);
    ivec2 cell = clamp(ivec2(scaled), 0, kGuideSize - 1);
    vec4 warp = warpAt(tile.block, cell);
    vec2 square = mix(warp.xz, warp.yw, clamp(scaled - vec2(cell), 0.0, 1.0));
#ifdef LAYERS
    int layer = k % layerCount;
    ivec2 entry = ivec2(tile.block % kTablesWide, (tile.block / kTablesWide) * layerCount + layer);
    uint scramble = READ(texelFetch(scrambles, entry, 0).r);
#else
    const int layer = 0;
    uint scramble = tile.tilePatch.scramble;
#endif
    ivec2 texel = tile.blockCorner + texelHolding(square, corner - tile.blockCorner, bits, scramble);
    Phatexel phatexel = unpackPhatexel(READ(texelFetch(phatexels, ivec3(texel, layer), 0).xy));
    if (!phatexel.valid) return found;

    float cellAngle = 1.02 / float(side);
    found.radiance = phatexel.radiance;
    found.direction = tile.tilePatch.worldFromBlock * phatexel.directionBlock;
    found.distance = min(phatexel.distance, kHorizonMeters);
    found.spread2 = cellAngle * cellAngle * clamp(1.0 / (2.0 * kPi * warpDensity(warp)), 0.05, 9.0);
    found.valid = true;
    if (aimed) {
        // Where one patch does not hold in the whole group, the texel's own tells its place.
        if (bits > tile.tilePatch.groupBits && (texel >> 3) != (q >> 3)) {
            tile.tilePatch = tilePatchAt(tilePatches, texel >> 3, chart.texelMeters);
            tile.middle = vec2(8 * (texel >> 3) + 4);
        }
        vec3 hit =
            placeOf(tile.tilePatch, vec2(texel) + 0.5 - tile.middle) + found.direction * found.distance;
        vec3 asStored = found.direction;
        found.distance = max(length(hit - r.position), 1e-6);
        found.direction = (hit - r.position) / found.distance;
        float parallax = 0.408 * float(side) * chart.texelMeters / d;
        found.spread2 += parallax * parallax;
        found.valid = 2.0 * (1.0 - dot(found.direction, wi)) <= 4.0 * found.spread2 &&
                      2.0 * (1.0 - dot(found.direction, asStored)) <= kMostTurn * kMostTurn;
    }
    found.valid = found.valid && found.distance <= kFarther * d + kSlackMeters;
    return found;
}

// A bias, named: a lobe under which the neighbourhood holds too few samples is drawn wider, because a blurred
// reflection disturbs less than the dots of single samples.
void widenLobe(inout Lobe lobe, ChartPlace chart, LookupTile here, inout Probe probe, vec3 mirror, float cosine) {
    mat3 worldFromBlock = here.tilePatch.worldFromBlock;
    float reach = max(searchRadius(distanceAlong(probe, worldFromBlock, mirror), chart.texelMeters), kLeastReachTexels);
    // The volume of the cone that places are drawn from, but no more texels than there are.
    float texels = min(kPi / 3.0 * reach * reach, float(chart.size.x * chart.size.y));
    float density = warpDensity(warpAt(here.block, hemisphereCell(mirror * worldFromBlock, kGuideSize)));
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
    if (wo.z <= 0.0) return vec4(0.0);
    ChartPlace chart = chartPlace(r.chart);
    ivec2 hereTexel = texelInChart(chart, r.texel, r.texel);
    LookupTile here = lookupTileAt(chart, hereTexel);
    mat3 worldFromBlock = here.tilePatch.worldFromBlock;
    Probe probe = probeAt(here, hereTexel, r.position);
    widenLobe(lobe, chart, here, probe, worldFromLocal * vec3(-wo.xy, wo.z), wo.z);

    vec4 sum = vec4(0.0);
    // Two draws ask at one place, as long as that answers.
    LookupTile tile = here;
    ivec2 place = hereTexel;
    for (int k = 0; k < drawCount; ++k) {
        vec4 u = vec4((draws[k] ^ ranks[rank]) >> 8) * exp2(-24.0);
        vec3 wi = reflect(-wo, squareToVisibleNormal(u.xy, wo, lobe.alpha));
        vec3 wiWorld = worldFromLocal * wi;
        if (wi.z <= 0.0 || dot(wiWorld, r.normalGeometric) <= 0.0) continue;
        float d = distanceAlong(probe, worldFromBlock, wiWorld);
        float radius = searchRadius(d, chart.texelMeters);
        for (int i = 0; i < kTries; ++i, radius = max(0.5 * radius, kLeastTexels), d *= kCloser) {
            if (i >= kAimedTries) radius = kNearTexels;
            if (i > 0 || (k & 1) == 0) {
                place = texelInChart(chart, r.texel + radius * squareToCone(u.zw, float(i)), r.texel);
                tile = lookupTileAt(chart, place);
            }
            Found found = ask(r, chart, tile, place, wiWorld, d, i < kAimedTries, k);
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
