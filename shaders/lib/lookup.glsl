// What arrives along a lobe: directions drawn from the BRDF, each answered by the PHATexel of a nearby block that
// looks there. ours, because averaging the neighbourhood instead reads thousands of texels a pixel for the same
// error (docs/lookup.md).
#include "lib/brdf.glsl"
#include "lib/frame.glsl"
#include "lib/sharpness.glsl"
#include "lib/visible_normal.glsl"

const int kMostDraws = 32;
const int kRanks = 16;

uniform uvec4 draws[kMostDraws];    // fractions of 2^32, the same for all pixels but for `ranks`
uniform uvec4 ranks[kRanks];
uniform int drawCount;              // at most kMostDraws
#ifdef AREA
uniform int lampBits;               // 2^lampBits texels a side, 2 to 5, are shared out to a group's 4x4 pixels
#endif

// The numbers below are the design study's, on one scene, unless a comment says more.
// Places that a draw asks, each in half the radius of the one before. A draw that drops out is a bias toward what is
// easy to find.
const int kTries = 3;
// Cells of the distance map by which every try but the first looks aside: beside a silhouette, which side a direction
// is on differs among the texels that share the map.
const float kAside = 1.0;
const float kLeastTexels = 2.0;
// What is within kContactTexels is asked for once more, of a group of 2^kNearBits texels a side, within kNearTexels,
// that answers as if it were the pixel: parallax in the smallest group may hide it from every aim.
const float kContactTexels = 6.0;
const int kNearBits = 3;
const float kNearTexels = 4.0;
const float kFewestTexels = 6.0;    // search radius: .7 of the distance, between these
const float kMostTexels = 128.0;
const float kFarther = 5.0;         // a sample that lies so many times farther than expected is behind something
// Radians between a sample's own direction and the one it gets when it is reconnected: what it saw of a glossy thing
// holds near its own direction alone.
const float kMostTurn = 0.5;
// Radians: beyond, what is close is another thing, however large cells are.
const float kMostMiss = 0.4;
const float kSlackMeters = 0.05;
// Samples that the neighbourhood must hold under a lobe. With fewer a sharp lobe shows single samples; more widen lobes
// at contacts, where places are drawn from a small one, until they see bright things far off; what does not aim has more
// around it there (docs/lookup.md).
const float kWantedSamples = 2.0;
const float kLeastReachTexels = 16.0;
const float kMostWidening = 20.0;

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

// 1/sr: guides are mixed with so much of the uniform density; a warp's 8 bits may say 0.
// twin: kUniformShare in src/core/phatexel/directions.cpp.
const float kLeastDensity = 0.3 / (2.0 * kPi);

struct Found {
    bool valid;
    vec3 radiance;
    vec3 direction;  // seen from the receiver
    float distance;
    float spread2;   // square of the angle that may lie between the direction found and the one asked for
    float density;   // 1/sr: of drawing that direction as the PHATexels were drawn, seen from the receiver
};

ivec2 groupCorner(LookupTile tile, ivec2 q, int bits) {
    return tile.blockCorner + (((q - tile.blockCorner) >> bits) << bits);
}

// `warp`: of the cell that the sample was drawn in.
Found foundIn(LookupTile tile, Phatexel phatexel, vec4 warp, int bits) {
    float angle = cellAngle(bits);
    float density = warpDensity(warp);
    float spread2 = angle * angle * clamp(1.0 / (2.0 * kPi * density), 0.05, 9.0);
    return Found(phatexel.valid, phatexel.radiance, tile.tilePatch.worldFromBlock * phatexel.directionBlock,
                 min(phatexel.distance, kHorizonMeters), spread2, max(density, kLeastDensity));
}

// As the receiver sees what the PHATexel of `texel` found. `tile`: of a texel around, whose patch holds in its group.
void reconnect(inout Found found, Receiver r, ChartPlace chart, LookupTile tile, ivec2 place, ivec2 texel, int bits) {
    // Where one patch does not hold in the whole group, the texel's own tells its place.
    if (bits > tile.tilePatch.groupBits && (texel >> 3) != (place >> 3)) {
        tile.tilePatch = tilePatchAt(tilePatches, texel >> 3, chart.texelMeters);
        tile.middle = vec2(8 * (texel >> 3) + 4);
    }
    vec3 hit = placeOf(tile.tilePatch, vec2(texel) + 0.5 - tile.middle) + found.direction * found.distance;
    float distance = max(length(hit - r.position), 1e-6);
    found.direction = (hit - r.position) / distance;
    float farther = distance / max(found.distance, 1e-6);
    found.density *= farther * farther;
    found.distance = distance;
}

// The sample toward `wi`, where something is expected at distance `d`, of the block around texel `q` of `tile`.
// `aimed`: toward the expected place, and reconnected to the receiver; else as if `q` were the receiver.
Found ask(Receiver r, ChartPlace chart, LookupTile tile, ivec2 q, vec3 wi, float d, bool aimed, int layer) {
    Found found;
    found.valid = false;
    int bits = aimed ? groupBits(chart.texelMeters, d) : kNearBits;
    int side = 1 << bits;
    ivec2 corner = groupCorner(tile, q, bits);
    vec3 center = placeOf(tile.tilePatch, vec2(corner) + 0.5 * float(side) - tile.middle);
    vec3 aim = (aimed ? normalize(r.position + wi * d - center) : wi) * tile.tilePatch.worldFromBlock;
    if (aim.z < 0.0) return found;

    vec2 scaled = hemisphereToSquare(aim) * float(kGuideSize);
    ivec2 cell = clamp(ivec2(scaled), 0, kGuideSize - 1);
    vec4 warp = warpAt(layer, tile.block, cell);
    vec2 square = mix(warp.xz, warp.yw, clamp(scaled - vec2(cell), 0.0, 1.0));
    ivec2 texel =
        tile.blockCorner + texelHolding(square, corner - tile.blockCorner, bits, scrambleOf(tile, layer));
    Phatexel phatexel = unpackPhatexel(READ(texelFetch(phatexels, ivec3(texel, layer), 0).xy));
    found = foundIn(tile, phatexel, warp, bits);
    if (!found.valid) return found;
    if (aimed) {
        vec3 asStored = found.direction;
        reconnect(found, r, chart, tile, q, texel, bits);
        float parallax = parallaxAngle(chart.texelMeters, d, bits);
        found.spread2 += parallax * parallax;
        found.valid = 2.0 * (1.0 - dot(found.direction, wi)) <= min(4.0 * found.spread2, kMostMiss * kMostMiss) &&
                      2.0 * (1.0 - dot(found.direction, asStored)) <= kMostTurn * kMostTurn;
    }
    found.valid = found.valid && found.distance <= kFarther * d + kSlackMeters;
    return found;
}

// A bias, named: a lobe under which the neighbourhood holds too few samples is drawn wider, because a blurred
// reflection disturbs less than the dots of single samples.
float widenedAlpha(Lobe lobe, ChartPlace chart, LookupTile here, inout Probe probe, vec3 mirror, float cosine) {
    float reach = max(searchRadius(distanceAlong(probe, mirror, vec2(0.0)), chart.texelMeters), kLeastReachTexels);
    // The volume of the cone that places are drawn from, but no more texels than there are.
    float texels = min(kPi / 3.0 * reach * reach, float(chart.size.x * chart.size.y));
    float density = warpDensity(warpAt(0, here.block, hemisphereCell(mirror * probe.worldFromBlock, kGuideSize, vec2(0.0))));
    // 1 / (integral of D^2) is 3 pi alpha^2 for small alpha, times d(light)/d(half) = 4 v.h.
    float solidAngle = min(12.0 * kPi * lobe.alpha * lobe.alpha * cosine, kPi);
    float widening = clamp(sqrt(kWantedSamples / max(texels * density * solidAngle, 1e-6)), 1.0, kMostWidening);
    return min(lobe.alpha * widening, max(lobe.alpha, 1.0));
}

// In [0,1): what the draw `k` of a pixel is made of.
vec4 drawNumbers(int k, int rank) {
    return vec4((draws[k] ^ ranks[rank]) >> 8) * exp2(-24.0);
}

// Where a draw asks.
struct Place {
    ivec2 texel;
    LookupTile tile;
};

void moveTo(inout Place place, ChartPlace chart, vec2 texel, vec2 around) {
    place.texel = texelInChart(chart, texel, around);
    place.tile = lookupTileAt(chart, place.texel);
}

// In [-1,1]^2, from what the draw's own numbers leave.
vec2 asideOf(vec2 u, int i) {
    return 2.0 * fract(4096.0 * u + float(i) * vec2(0.754877, 0.569840)) - 1.0;
}

// What a PHATexel of `layer` saw toward `wi`. `u`: the draw's. `place`: the first one that is asked, or with `away` any;
// that which answered.
Found answer(Receiver r, ChartPlace chart, vec3 normal, vec3 wi, vec4 u, int layer, bool away, inout Probe probe,
             inout Place place) {
    Found found;
    float d = distanceAlong(probe, wi, vec2(0.0));
    float radius = searchRadius(d, chart.texelMeters);
    int tries = d < kContactTexels * chart.texelMeters ? kTries + 1 : kTries;
    for (int i = 0; i < tries; ++i, radius = max(0.5 * radius, kLeastTexels)) {
        bool aimed = i < kTries;
        if (i > 0) d = distanceAlong(probe, wi, kAside * asideOf(u.wz, i));
        if (i > 0 || away) {
            float reach = aimed ? radius : kNearTexels;
            moveTo(place, chart, r.texel + reach * squareToCone(u.zw, float(i)), r.texel);
        }
        found = ask(r, chart, place.tile, place.texel, wi, d, aimed, layer);
        found.valid = found.valid && dot(found.direction, normal) > 0.0;
        if (found.valid) break;
    }
    return found;
}

// What the lobe sees.
struct SeenLight {
    vec4 indirect;  // sum g L, sum g over a pixel's draws: to be divided
    vec4 area;      // the same of area lights, less what `lamps` has
    vec4 lamps;     // reflected radiance, and luminance of the irradiance, both by the PHATexels nearby
};

#ifdef AREA
// Of the draws, those that ask for area lights, too.
const int kAreaEvery = 3;

int areaDraws() {
    return (drawCount + kAreaEvery - 1) / kAreaEvery;
}

// PHATexels of a pixel's own.
int lampsEach() {
    return 1 << (2 * lampBits - 4);
}

// The part of a sample that the draws take, the rest is the lamps': the balance heuristic.
float drawsShare(float drawnPdf, Found found) {
    float draws = float(areaDraws()) * drawnPdf;
    return draws / (draws + float(lampsEach()) * found.density);
}

// Lamps are small: draws from a rough lobe seldom meet one. So area lights are also asked the other way round: each of a
// group's 4x4 pixels takes its share of the cells of one unit square, whose samples crowd where lamps are, and both
// ways share by the balance heuristic (docs/lookup.md).
void addLamps(inout vec4 sum, Receiver r, ChartPlace chart, mat3 worldFromLocal, vec3 wo, Lobe lobe, float drawnAlpha,
              int rank, vec2 u, Place place) {
    int side = 1 << lampBits, across = side / 4;
    moveTo(place, chart, r.texel + kNearTexels * squareToCone(u, 0.0), r.texel);
    ivec2 corner = groupCorner(place.tile, place.texel, lampBits) - place.tile.blockCorner;
    uint scramble = scrambleOf(place.tile, layerCount);
    for (int i = 0; i < lampsEach(); ++i) {
        vec2 cell = vec2(4 * (i % across) + (rank & 3), 4 * (i / across) + (rank >> 2));
        ivec2 texel =
            place.tile.blockCorner + texelHolding((cell + 0.5) / float(side), corner, lampBits, scramble);
        Phatexel phatexel = unpackPhatexel(READ(texelFetch(phatexels, ivec3(texel, layerCount), 0).xy));
        if (!phatexel.valid) continue;
        vec4 warp = warpAt(layerCount, place.tile.block, hemisphereCell(phatexel.directionBlock, kGuideSize, vec2(0.0)));
        // The smear of the draws that might have found the same.
        Found found = foundIn(place.tile, phatexel, warp, groupBits(chart.texelMeters, phatexel.distance));
        reconnect(found, r, chart, place.tile, place.texel, texel, lampBits);
        vec3 w = found.direction * worldFromLocal;
        if (w.z <= 0.0 || dot(found.direction, r.normalGeometric) <= 0.0) continue;
        float share = 1.0 - drawsShare(smoothedLobePdf(wo, w, drawnAlpha, found.spread2), found);
        vec3 arriving = found.radiance / found.density;
        sum += vec4(share * lobeValue(lobe, wo, w) * arriving, luminance(w.z * arriving));
    }
}
#endif

// `rank`: which sixteenth of the numbers is the pixel's own; `drawnAlpha`: of the lobe as it was drawn.
SeenLight lookUp(Receiver r, Lobe lobe, int rank, out float drawnAlpha) {
    drawnAlpha = lobe.alpha;
    SeenLight seen = SeenLight(vec4(0.0), vec4(0.0), vec4(0.0));
    mat3 worldFromLocal = frameFromNormal(lobe.normal);
    vec3 wo = r.towardEye * worldFromLocal;
    if (wo.z <= 0.0) return seen;
    ChartPlace chart = chartPlace(r.chart);
    ivec2 hereTexel = texelOfRank(chart, r.texel, rank);
    LookupTile here = lookupTileAt(chart, hereTexel);
    Probe probe = probeAt(here, hereTexel, r.position);
    drawnAlpha = widenedAlpha(lobe, chart, here, probe, worldFromLocal * vec3(-wo.xy, wo.z), wo.z);
    Lobe wide = Lobe(lobe.normal, lobe.f0, lobe.f90, drawnAlpha);

    Place place = Place(hereTexel, here);
#ifdef AREA
    READS_FOR(1);
    addLamps(seen.lamps, r, chart, worldFromLocal, wo, lobe, drawnAlpha, rank, drawNumbers(0, rank).zw, place);
    READS_FOR(0);
#endif
    for (int k = 0; k < drawCount; ++k) {
        vec4 u = drawNumbers(k, rank);
        vec3 wi = reflect(-wo, squareToVisibleNormal(u.xy, wo, drawnAlpha));
        vec3 wiWorld = worldFromLocal * wi;
        if (wi.z <= 0.0 || dot(wiWorld, r.normalGeometric) <= 0.0) continue;
        // Two draws ask at one place, as long as that answers.
        Found found = answer(r, chart, lobe.normal, wiWorld, u, k % layerCount, (k & 1) == 0, probe, place);
        if (found.valid) {
            vec3 w = found.direction * worldFromLocal;
            // g = f cos / pdf. The sample's own pdf and the Jacobian cancel: cells hold equal shares of the density
            // (docs/lookup.md).
            float g = lobeValue(wide, wo, w) / smoothedLobePdf(wo, w, drawnAlpha, found.spread2);
            seen.indirect += g * vec4(found.radiance, 1.0);
        }
#ifdef AREA
        if (k % kAreaEvery != 0) continue;
        READS_FOR(1);
        found = answer(r, chart, lobe.normal, wiWorld, u, layerCount, false, probe, place);
        if (found.valid) {
            vec3 w = found.direction * worldFromLocal;
            float pdf = smoothedLobePdf(wo, w, drawnAlpha, found.spread2);
            float g = lobeValue(lobe, wo, w) / pdf;
            seen.area += g * vec4(drawsShare(pdf, found) * found.radiance, 1.0);
        }
        READS_FOR(0);
#endif
    }
    return seen;
}
