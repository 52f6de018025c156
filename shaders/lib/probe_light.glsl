// Irradiance anywhere in a baked room, for things that were not in the bake. Reads at most 3 texels of cells, and of
// each of eight probes one of distances and two of light, four where there are area lights: 43 in all.
// twin: LightProbes in src/core/probes/light_probes.h; src/gl/probe_upload.cpp writes the tables.
#include "lib/phatexel.glsl"
#include "lib/table.glsl"

uniform usampler2D probeCells;      // table: ProbeCell, two probes a word
uniform usampler2D probeLight;      // table: PackedIrradianceSh and PackedPlace; then the same of area lights
uniform usampler2D probeDistances;  // table: a word for each square of the octahedron, its corners' codes
uniform vec3 probeLow;              // of the grid, metres
uniform vec3 probeCellMeters;
uniform vec3 probeGrid;             // cells
uniform int probeTexels;            // of a probe in probeLight: 2, or 4 with area lights

// twin: kNoProbe, kDividedCell, kMaxCellDivisions in src/core/probes/light_probes.h.
const uint kNoProbe = 0xffffu;
const uint kDividedCell = 0xfffeu;
const int kMaxCellDivisions = 2;
// twin: kOffsetFraction in src/core/probes/light_probes.cpp.
const float kOffsetFraction = 0.25;
// twin: kDistanceIntervals in src/core/probes/probe_distances.h.
const int kDistanceIntervals = 3;
// twin: kSeenWithin, kHiddenFrom, kHiddenWeight, kHiddenHalvings, kMinWeight, kRangeSteps, kRangeLowest in
// src/core/probes/probe_distances.cpp.
const float kSeenWithin = 1.02;
const float kHiddenFrom = 1.06;
const float kHiddenWeight = 1e-4;
const float kHiddenHalvings = 60.0;
const float kMinWeight = 1e-30;
const float kRangeSteps = 16.0;
const float kRangeLowest = -4.0;

struct ProbeCell {
    uvec4 probes;
    vec3 low;
    vec3 size;
};

uint probeAt(uvec4 cell, int corner) {
    uint pair = cell[corner >> 1];
    return (corner & 1) == 0 ? pair & 0xffffu : pair >> 16;
}

// The undivided cell that a point is in, or that is nearest.
ProbeCell probeCellAt(vec3 position) {
    vec3 cell = clamp(floor((position - probeLow) / probeCellMeters), vec3(0.0), probeGrid - 1.0);
    ProbeCell found = ProbeCell(uvec4(0u), probeLow + cell * probeCellMeters, probeCellMeters);
    ivec3 c = ivec3(cell), grid = ivec3(probeGrid);
    found.probes = texelFetch(probeCells, tableTexel((c.z * grid.y + c.y) * grid.x + c.x), 0);
    for (int division = 0; division < kMaxCellDivisions && probeAt(found.probes, 0) == kDividedCell; ++division) {
        int child = int(found.probes.x >> 16 | found.probes.y << 16);
        found.size *= 0.5;
        bvec3 high = greaterThanEqual(position, found.low + found.size);
        found.low += vec3(high) * found.size;
        child += (high.x ? 1 : 0) + (high.y ? 2 : 0) + (high.z ? 4 : 0);
        found.probes = texelFetch(probeCells, tableTexel(child), 0);
    }
    return found;
}

// Byte 0 to 3 of a word, from -1 to 1.
float signedByte(uint word, int which) {
    return float(int(word << (24 - 8 * which)) >> 24) / 127.0;
}

float probeUnitMeters() {
    return max(probeCellMeters.x, max(probeCellMeters.y, probeCellMeters.z));
}

// twin: probeVisibility in src/core/probes/probe_distances.h. `place`: PackedPlace.
float probeVisibility(uint probe, uint place, vec3 offset) {
    vec3 size = abs(offset);
    float t = size.x + size.y + size.z;
    if (t <= 0.0) return 1.0;
    vec2 square = size.xy / t;
    if (offset.z < 0.0) square = 1.0 - square.yx;
    vec2 at = float(kDistanceIntervals) * square;
    ivec2 corner = min(ivec2(at), ivec2(kDistanceIntervals - 1));
    vec2 f = at - vec2(corner);
    int quarter = (offset.x < 0.0 ? 1 : 0) + (offset.y < 0.0 ? 2 : 0);
    int word = ((int(probe) * 4 + quarter) * kDistanceIntervals + corner.y) * kDistanceIntervals + corner.x;
    uint codes = texelFetch(probeDistances, tableTexel(word >> 2), 0)[word & 3];
    // Nodes (0, 0), (1, 0), (0, 1), (1, 1).
    vec4 code = vec4(uvec4(codes, codes >> 8, codes >> 16, codes >> 24) & 0xffu);
    float diagonal = f.x + f.y;
    float mean = diagonal <= 1.0 ? (1.0 - diagonal) * code.x + f.x * code.y + f.y * code.z
                                 : (diagonal - 1.0) * code.w + (1.0 - f.x) * code.z + (1.0 - f.y) * code.y;
    float range = exp2(float(place >> 24) / kRangeSteps + kRangeLowest) / probeUnitMeters();
    float before = kHiddenFrom - t * mean / 255.0 * range;
    float seen = clamp(before / (kHiddenFrom - kSeenWithin), 0.0, 1.0);
    return max(max(seen, kHiddenWeight * exp2(kHiddenHalvings * min(before, 0.0))), kMinWeight);
}

// The terms that depend on the direction alone, times the bounds of their ratios to the mean.
// twin: shTerms, shRatioBound in src/core/probes/probe_sh.h.
struct ShTerms {
    vec4 low;   // x, y, z, (3 z^2 - 1) / 2
    vec4 high;  // x^2 - y^2, x y, y z, z x
};
ShTerms shTerms(vec3 d) {
    return ShTerms(vec4(2.0 * d, 1.25 * (1.5 * d.z * d.z - 0.5)),
                   vec4(0.9375 * (d.x * d.x - d.y * d.y), 1.875 * d.x * d.y, 1.875 * d.y * d.z, 1.875 * d.z * d.x));
}

// PackedIrradianceSh in two texels. twin: IrradianceSh in src/core/probes/probe_sh.h.
struct IrradianceSh {
    vec3 mean;
    vec3 ratio[8];  // of the other coefficients to the mean and their bounds
    vec3 main;      // the main direction of the light; zero: it has none
};
IrradianceSh unpackSh(uvec4 first, uvec4 second) {
    uint words[6] = uint[6](first.y, first.z, first.w, second.x, second.y, second.z);
    IrradianceSh sh;
    sh.mean = unpackRgb9e5(first.x);
    for (int term = 0; term < 8; ++term)
        for (int channel = 0; channel < 3; ++channel) {
            int i = 3 * term + channel;
            sh.ratio[term][channel] = signedByte(words[i >> 2], i & 3);
        }
    const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);
    vec3 weight = kLuminance * sh.mean;
    vec3 main = 2.0 * vec3(dot(weight, sh.ratio[0]), dot(weight, sh.ratio[1]), dot(weight, sh.ratio[2]));
    float size = length(main);
    sh.main = size > 1e-6 * dot(kLuminance, sh.mean) ? main / size : vec3(0.0);
    return sh;
}

// Over the mean.
vec3 shOrder2(IrradianceSh sh, ShTerms terms) {
    vec3 sum = terms.low[3] * sh.ratio[3];
    for (int i = 0; i < 4; ++i) sum += terms.high[i] * sh.ratio[4 + i];
    return sum;
}

vec3 shIrradiance(IrradianceSh sh, vec3 normal) {
    ShTerms terms = shTerms(normal);
    vec3 sum = 1.0 + shOrder2(sh, terms);
    for (int i = 0; i < 3; ++i) sum += terms.low[i] * sh.ratio[i];
    if (sh.main != vec3(0.0)) {
        vec3 p2 = clamp(shOrder2(sh, shTerms(sh.main)) / 1.25, 0.0, 1.0);
        float c = dot(normal, sh.main);
        sum += 4.0 * p2 * p2 * p2 * (max(c, 0.0) - 0.25 - 0.5 * c - 0.3125 * (1.5 * c * c - 0.5));
    }
    return max(sh.mean * sum, vec3(0.0));
}

// Irradiance, W/m2, of a surface with one normal and of one with another: the diffuse part's, and the one that faces
// where a mirror shows.
struct ProbeIrradiance {
    vec3 indirect[2];
    vec3 area[2];
};

// twin: probeIrradianceAt in src/core/probes/light_probes.h; tests/gl compares the two.
ProbeIrradiance probeIrradiance(vec3 position, vec3 normals[2]) {
    ProbeIrradiance sum = ProbeIrradiance(vec3[2](vec3(0.0), vec3(0.0)), vec3[2](vec3(0.0), vec3(0.0)));
    ProbeCell cell = probeCellAt(position);
    if (probeAt(cell.probes, 0) == kDividedCell) return sum;
    vec3 at = clamp((position - cell.low) / cell.size, 0.0, 1.0);
    float weights = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        uint probe = probeAt(cell.probes, corner);
        if (probe == kNoProbe) continue;
        int texel = int(probe) * probeTexels;
        uvec4 first = texelFetch(probeLight, tableTexel(texel), 0);
        uvec4 second = texelFetch(probeLight, tableTexel(texel + 1), 0);
        uint place = second.w;
        vec3 side = vec3(corner & 1, corner >> 1 & 1, corner >> 2);
        vec3 along = mix(1.0 - at, at, side);
        vec3 offset = vec3(signedByte(place, 0), signedByte(place, 1), signedByte(place, 2));
        vec3 from = cell.low + side * cell.size + kOffsetFraction * probeUnitMeters() * offset;
        float weight = along.x * along.y * along.z * probeVisibility(probe, place, position - from);
        weights += weight;
        IrradianceSh sh = unpackSh(first, second);
        for (int i = 0; i < 2; ++i) sum.indirect[i] += weight * shIrradiance(sh, normals[i]);
        if (probeTexels < 4) continue;
        first = texelFetch(probeLight, tableTexel(texel + 2), 0);
        second = texelFetch(probeLight, tableTexel(texel + 3), 0);
        sh = unpackSh(first, second);
        for (int i = 0; i < 2; ++i) sum.area[i] += weight * shIrradiance(sh, normals[i]);
    }
    for (int i = 0; i < 2; ++i) {
        sum.indirect[i] = weights > 0.0 ? sum.indirect[i] / weights : vec3(0.0);
        sum.area[i] = weights > 0.0 ? sum.area[i] / weights : vec3(0.0);
    }
    return sum;
}
