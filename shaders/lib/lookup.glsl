// Incident radiance under a lobe: directions sampled from the BRDF, each with the radiance of the PHATexel of a nearby
// block that has this direction. ours, because averaging the neighbourhood instead reads thousands of texels a pixel for
// the same error (docs/lookup.md).
#include "lib/frame.glsl"
#include "lib/sample_numbers.glsl"
#include "lib/scalar_lobe.glsl"
#include "lib/sharpness.glsl"
#include "lib/visible_normal.glsl"

uniform int sampleCount;                   // at most kMaxSamples
#ifdef AREA
uniform int lightBits;  // the 4x4 pixels of a group read 2^lightBits texels a side together, 2 to 5
#endif

// The numbers below are the design study's, on one scene, unless a comment says more.
//
// Texels that are tried for a sample, each within half the radius of the one before. A sample that is rejected in all
// of them is a bias toward what is easy to find.
const int kTries = 3;
// Cells of the depth probe by which every try but the first is jittered: at a silhouette, the texels of a tile differ
// in which side of it a direction meets.
const float kAside = 1.0;
const float kMinRetryTexels = 2.0;
// Hits closer than kContactTexels are tried once more, in a group of 2^kNearBits texels a side within kNearTexels,
// whose sample is taken as if it were the pixel's own: parallax in the smallest group may hide it from every aim.
const float kContactTexels = 6.0;
const int kNearBits = 3;
const float kNearTexels = 4.0;
const float kMinSearchTexels = 6.0;   // search radius: .7 of the distance, between these
const float kMaxSearchTexels = 128.0;
const float kFarther = 5.0;           // a sample so many times farther than expected is occluded from the receiver
// Radians between a sample's own direction and the one it gets when it is reconnected: the radiance of a glossy surface
// holds near the sample's own direction alone.
const float kMaxTurn = 0.5;
// Radians: beyond, the sample is of another surface, however large cells are.
const float kMaxMiss = 0.4;
const float kMinDistance = 1e-6;      // units of length, against division by zero
const float kSlack = 0.05;            // units of length that it may be farther than that
// Samples that the neighbourhood must hold under a lobe. With fewer a sharp lobe shows single samples. With more,
// lobes at contacts, where the neighbourhood is small, become so rough that they reflect bright surfaces far away; the
// last try, by direction alone, has a larger group there (docs/lookup.md).
const float kMinSamplesUnderLobe = 2.0;
const float kMinReachTexels = 16.0;
const float kMaxAlphaScale = 20.0;

// The surface point whose reflected light is looked up.
struct Receiver {
    vec3 position;
    vec3 towardEye;
    vec3 normal;           // of the vertices, as the irradiance has it
    vec3 normalGeometric;
    vec2 texel;
    uint chart;
};

// A lookup of the light that one lobe of a receiver reflects.
struct LookupQuery {
    Receiver receiver;
    ChartExtent chart;
    ScalarLobe lobe;
    ScalarLobe sampledLobe;  // the same after the roughness clamp: directions are sampled from it
    mat3 worldFromLocal;     // local z: the lobe's normal
    vec3 wo;                 // toward the eye, local
    int rank;                // of the pixel in its group of 4x4: chooses its sample numbers
};

// The state of the search: the texel whose block is read, its tile, and the depth probe of the receiver.
struct LookupCursor {
    ivec2 texel;
    LookupTile tile;
    DepthProbe probe;
};

// The target of a search in a group of texels.
struct LookupAim {
    vec3 direction;   // world, from the receiver
    float distance;   // metres, to the surface that the depth probe expects
    bool reconnects;  // aims at the expected position, else along `direction` as if the texel were the receiver
    int layer;
};

struct LookupSample {
    bool valid;
    vec3 radiance;
    vec3 direction;  // world, from the receiver
    float distance;
    float spread2;   // square of the expected angle between the sample's direction and the aim's
    float density;   // 1/sr: of that direction in the distribution of the PHATexels, at the receiver
};

float searchRadius(float distance, float texelMeters) {
    return clamp(0.7 * distance / texelMeters, kMinSearchTexels, kMaxSearchTexels);
}

// `cell`: of the inverse CDF, the one that the PHATexel was drawn in.
LookupSample sampleFrom(LookupTile tile, Phatexel phatexel, vec4 cell, int bits) {
    float angle = cellAngle(bits);
    float density = cellDensity(cell);
    float spread2 = angle * angle * clamp(1.0 / (2.0 * kPi * density), 0.05, 9.0);
    return LookupSample(phatexel.valid, phatexel.radiance, tile.tilePatch.worldFromBlock * phatexel.directionBlock,
                        min(phatexel.distance, kHorizon * unitMeters), spread2, max(density, kMinDensity));
}

// Moves the sample of `texel`'s PHATexel to the receiver. `cursor`: at a texel of the same group of 2^bits a side.
void reconnect(inout LookupSample found, LookupQuery query, LookupCursor cursor, ivec2 texel, int bits) {
    LookupTile tile = cursor.tile;
    // Where one patch does not fit the whole group, the texel's position is that of its own.
    if (bits > tile.tilePatch.groupBits && (texel >> 3) != (cursor.texel >> 3)) {
        tile.tilePatch = tilePatchAt(tilePatches, texel >> 3, query.chart.texelMeters);
        tile.middle = vec2(8 * (texel >> 3) + 4);
    }
    vec3 hit = positionOnPatch(tile.tilePatch, vec2(texel) + 0.5 - tile.middle) + found.direction * found.distance;
    vec3 origin = query.receiver.position;
    float distance = max(length(hit - origin), kMinDistance * unitMeters);
    found.direction = (hit - origin) / distance;
    float farther = distance / max(found.distance, kMinDistance * unitMeters);
    found.density *= farther * farther;
    found.distance = distance;
}

// The sample along `aim` of the block around the cursor.
LookupSample sampleAtCursor(LookupQuery query, LookupCursor cursor, LookupAim aim) {
    LookupSample found;
    found.valid = false;
    LookupTile tile = cursor.tile;
    float texelMeters = query.chart.texelMeters;
    int bits = aim.reconnects ? groupBits(texelMeters, aim.distance) : kNearBits;
    int side = 1 << bits;
    ivec2 corner = groupCorner(tile, cursor.texel, bits);
    vec3 center = positionOnPatch(tile.tilePatch, vec2(corner) + 0.5 * float(side) - tile.middle);
    vec3 expected = query.receiver.position + aim.direction * aim.distance;
    vec3 directionBlock =
        (aim.reconnects ? normalize(expected - center) : aim.direction) * tile.tilePatch.worldFromBlock;
    if (directionBlock.z < 0.0) return found;

    vec2 scaled = hemisphereToSquare(directionBlock) * float(kGuideSize);
    ivec2 at = clamp(ivec2(scaled), 0, kGuideSize - 1);
    vec4 cell = inverseCdfCellAt(aim.layer, tile.block, at);
    vec2 square = mix(cell.xz, cell.yw, clamp(scaled - vec2(at), 0.0, 1.0));
    ivec2 texel =
        tile.blockCorner + texelHolding(square, corner - tile.blockCorner, bits, scrambleOf(tile, aim.layer));
    if (!isInChart(query.chart, texel)) return found;
    Phatexel phatexel = unpackPhatexel(READ(texelFetch(phatexels, ivec3(texel, aim.layer), 0).xy));
    found = sampleFrom(tile, phatexel, cell, bits);
    if (!found.valid) return found;
    if (aim.reconnects) {
        vec3 asStored = found.direction;
        reconnect(found, query, cursor, texel, bits);
        float parallax = parallaxAngle(texelMeters, aim.distance, bits);
        found.spread2 += parallax * parallax;
        float miss2 = 2.0 * (1.0 - dot(found.direction, aim.direction));
        float turn2 = 2.0 * (1.0 - dot(found.direction, asStored));
        found.valid = miss2 <= min(4.0 * found.spread2, kMaxMiss * kMaxMiss) && turn2 <= kMaxTurn * kMaxTurn;
    }
    found.valid = found.valid && found.distance <= kFarther * aim.distance + kSlack * unitMeters;
    return found;
}

// The roughness clamp, a bias: a lobe under which the neighbourhood holds too few samples is made rougher, because a
// blurred reflection disturbs less than the fireflies of single samples. pre: the cursor is at the receiver.
float clampedAlpha(LookupQuery query, inout LookupCursor cursor) {
    vec3 wo = query.wo;
    float alpha = query.lobe.alpha;
    vec3 mirror = query.worldFromLocal * vec3(-wo.xy, wo.z);
    float distance = distanceAlong(cursor.probe, mirror, vec2(0.0));
    float reach = max(searchRadius(distance, query.chart.texelMeters), kMinReachTexels);
    // The volume of the cone that texels are sampled from, but no more texels than the chart has.
    float texels = min(kPi / 3.0 * reach * reach, float(query.chart.size.x * query.chart.size.y));
    ivec2 at = hemisphereCell(mirror * cursor.probe.worldFromBlock, kGuideSize, vec2(0.0));
    float density = cellDensity(inverseCdfCellAt(0, cursor.tile.block, at));
    // 1 / (integral of D^2) is 3 pi alpha^2 for small alpha, times d(light)/d(half) = 4 v.h.
    float solidAngle = min(12.0 * kPi * alpha * alpha * wo.z, kPi);
    float scale = clamp(sqrt(kMinSamplesUnderLobe / max(texels * density * solidAngle, 1e-6)), 1.0, kMaxAlphaScale);
    return min(alpha * scale, max(alpha, 1.0));
}

void moveTo(inout LookupCursor cursor, LookupQuery query, vec2 texel) {
    cursor.texel = texelInChart(query.chart, texel, query.receiver.texel);
    cursor.tile = lookupTileAt(query.chart, cursor.texel);
}

// In [-1,1]^2, from the low bits of the sample's own numbers.
vec2 asideOf(vec2 u, int i) {
    return 2.0 * fract(4096.0 * u + float(i) * vec2(0.754877, 0.569840)) - 1.0;
}

// The sample of a PHATexel of `layer` toward `direction`. `u`: the sample's numbers. The first try is at the cursor, or
// with `moves` at any texel around; afterwards the cursor is at the texel of the last try.
LookupSample findSample(LookupQuery query, inout LookupCursor cursor, vec3 direction, vec4 u, int layer, bool moves) {
    LookupSample found;
    float texelMeters = query.chart.texelMeters;
    float distance = distanceAlong(cursor.probe, direction, vec2(0.0));
    float radius = searchRadius(distance, texelMeters);
    int tries = distance < kContactTexels * texelMeters ? kTries + 1 : kTries;
    for (int i = 0; i < tries; ++i, radius = max(0.5 * radius, kMinRetryTexels)) {
        bool reconnects = i < kTries;
        if (i > 0) distance = distanceAlong(cursor.probe, direction, kAside * asideOf(u.wz, i));
        if (i > 0 || moves) {
            float reach = reconnects ? radius : kNearTexels;
            moveTo(cursor, query, query.receiver.texel + reach * squareToCone(u.zw, float(i)));
        }
        found = sampleAtCursor(query, cursor, LookupAim(direction, distance, reconnects, layer));
        found.valid = found.valid && dot(found.direction, query.lobe.normalWorld) > 0.0;
        if (found.valid) break;
    }
    return found;
}

// Incident light under a lobe.
struct IncidentSums {
    vec4 indirect;     // sum g L, sum g over a pixel's samples: to be divided
    vec2 cosine;       // sum h Y(L), sum h of the same samples, h = cos / pdf: estimates the irradiance over pi
    vec4 area;         // the same of area lights, less what `areaByLight` has
    vec4 areaByLight;  // reflected radiance, and luminance of the irradiance, both by the PHATexels nearby
};

// 1/sr, of sampling the lobe in the sample's direction, with the blur of the PHATexels.
float brdfPdf(LookupQuery query, LookupSample found) {
    vec3 w = found.direction * query.worldFromLocal;
    return smoothedLobePdf(query.wo, w, query.sampledLobe.alpha, found.spread2);
}

#ifdef AREA
// Every so many samples, the direction is looked up in the PHATexels of area lights, too.
const int kAreaEvery = 3;

int areaSampleCount() {
    return (sampleCount + kAreaEvery - 1) / kAreaEvery;
}

// How many PHATexels a pixel reads for its light samples.
int lightSampleCount() {
    return 1 << (2 * lightBits - 4);
}

// The weight of a BRDF sample by the balance heuristic; addLightSamples has the rest.
float brdfWeight(float pdf, LookupSample found) {
    float brdf = float(areaSampleCount()) * pdf;
    return brdf / (brdf + float(lightSampleCount()) * found.density);
}

// Area lights are small: samples of a rough lobe seldom meet one. So the lights are sampled, too: each of a group's 4x4
// pixels takes its part of the cells of one unit square, whose samples crowd where area lights are, and the two
// strategies are weighted by the balance heuristic (docs/lookup.md). The cursor of the caller stays.
void addLightSamples(inout vec4 sum, LookupQuery query, LookupCursor cursor, vec2 u) {
    int side = 1 << lightBits, across = side / 4;
    moveTo(cursor, query, query.receiver.texel + kNearTexels * squareToCone(u, 0.0));
    LookupTile tile = cursor.tile;
    ivec2 corner = groupCorner(tile, cursor.texel, lightBits) - tile.blockCorner;
    uint scramble = scrambleOf(tile, layerCount);
    for (int i = 0; i < lightSampleCount(); ++i) {
        vec2 part = vec2(4 * (i % across) + (query.rank & 3), 4 * (i / across) + (query.rank >> 2));
        ivec2 texel = tile.blockCorner + texelHolding((part + 0.5) / float(side), corner, lightBits, scramble);
        if (!isInChart(query.chart, texel)) continue;
        Phatexel phatexel = unpackPhatexel(READ(texelFetch(phatexels, ivec3(texel, layerCount), 0).xy));
        if (!phatexel.valid) continue;
        ivec2 at = hemisphereCell(phatexel.directionBlock, kGuideSize, vec2(0.0));
        vec4 cell = inverseCdfCellAt(layerCount, tile.block, at);
        // The blur of the BRDF's samples that might have found the same.
        LookupSample found = sampleFrom(tile, phatexel, cell, groupBits(query.chart.texelMeters, phatexel.distance));
        reconnect(found, query, cursor, texel, lightBits);
        vec3 w = found.direction * query.worldFromLocal;
        if (w.z <= 0.0 || dot(found.direction, query.receiver.normalGeometric) <= 0.0) continue;
        float weight = 1.0 - brdfWeight(brdfPdf(query, found), found);
        vec3 arriving = found.radiance / found.density;
        sum += vec4(weight * lobeValueLocal(query.lobe, query.wo, w) * arriving, luminance(w.z * arriving));
    }
}
#endif

// g = f cos / pdf. The sample's own pdf and the Jacobian cancel: cells hold equal parts of the density (docs/lookup.md).
void addBrdfSample(inout IncidentSums sums, LookupQuery query, LookupSample found, int source) {
    float pdf = brdfPdf(query, found);
    ScalarLobe lobe = query.lobe;
    if (source == 0) lobe.alpha = query.sampledLobe.alpha;
    float g = lobeValueLocal(lobe, query.wo, found.direction * query.worldFromLocal) / pdf;
#ifdef AREA
    if (source == 1) {
        sums.area += g * vec4(brdfWeight(pdf, found) * found.radiance, 1.0);
        return;
    }
#endif
    sums.indirect += g * vec4(found.radiance, 1.0);
    float h = max(dot(found.direction, query.receiver.normal), 0.0) / pdf;
    sums.cosine += h * vec2(luminance(found.radiance), 1.0);
}

// `rank`: see LookupQuery; `sampledAlpha`: of the lobe after the roughness clamp.
IncidentSums lookUp(Receiver r, ScalarLobe lobe, int rank, out float sampledAlpha) {
    sampledAlpha = lobe.alpha;
    IncidentSums sums = IncidentSums(vec4(0.0), vec2(0.0), vec4(0.0), vec4(0.0));
    mat3 worldFromLocal = frameFromNormal(lobe.normalWorld);
    vec3 wo = r.towardEye * worldFromLocal;
    if (wo.z <= 0.0) return sums;
    LookupQuery query = LookupQuery(r, chartExtent(r.chart), lobe, lobe, worldFromLocal, wo, rank);
    ivec2 texel = texelOfRank(query.chart, r.texel, rank);
    LookupTile tile = lookupTileAt(query.chart, texel);
    LookupCursor cursor = LookupCursor(texel, tile, depthProbeAt(tile, texel, r.position));
    sampledAlpha = clampedAlpha(query, cursor);
    query.sampledLobe.alpha = sampledAlpha;
#ifdef AREA
    READS_FOR(1);
    addLightSamples(sums.areaByLight, query, cursor, sampleNumbersOf(0, rank).zw);
    READS_FOR(0);
#endif
    for (int k = 0; k < sampleCount; ++k) {
        vec4 u = sampleNumbersOf(k, rank);
        vec3 wi = reflect(-wo, squareToVisibleNormal(u.xy, wo, sampledAlpha));
        vec3 wiWorld = worldFromLocal * wi;
        if (wi.z <= 0.0 || dot(wiWorld, r.normalGeometric) <= 0.0) continue;
        // Two samples begin at one texel, unless the first had to go elsewhere.
        LookupSample found = findSample(query, cursor, wiWorld, u, k % layerCount, (k & 1) == 0);
        if (found.valid) addBrdfSample(sums, query, found, 0);
#ifdef AREA
        if (k % kAreaEvery != 0) continue;
        READS_FOR(1);
        found = findSample(query, cursor, wiWorld, u, layerCount, false);
        if (found.valid) addBrdfSample(sums, query, found, 1);
        READS_FOR(0);
#endif
    }
    return sums;
}
