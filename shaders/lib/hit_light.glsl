// What a surface reflects sharply, at the hit of a ray: the PHATexel of the neighbourhood that the reflected direction
// leads to. source: Hensley et al. 2003: the paper's structure, at the second bounce; the search is the lookup's.
#include "lib/lookup.glsl"

// A point whose reflected light is looked up, and the search's state there.
struct HitLookup {
    LookupQuery query;
    LookupCursor cursor;
};

HitLookup hitLookup(Receiver r, ScalarLobe lobe, mat3 worldFromLocal, vec3 wo, int rank) {
    LookupQuery query = LookupQuery(r, chartExtent(r.chart), lobe, lobe, worldFromLocal, wo, rank);
    ivec2 texel = texelInChart(query.chart, r.texel, r.texel);
    LookupTile tile = lookupTileAt(query.chart, texel);
    return HitLookup(query, LookupCursor(texel, tile, depthProbeAt(tile, texel, r.position)));
}

// The radiance of the PHATexel of `layer` that has the direction, of a small group around a texel; negative where there
// is none.
vec3 storedToward(ChartExtent chart, LookupTile tile, ivec2 texel, vec3 direction, int layer) {
    vec3 directionBlock = direction * tile.tilePatch.worldFromBlock;
    if (directionBlock.z <= 0.0) return vec3(-1.0);
    vec2 scaled = hemisphereToSquare(directionBlock) * float(kGuideSize);
    ivec2 at = clamp(ivec2(scaled), 0, kGuideSize - 1);
    vec4 cell = inverseCdfCellAt(layer, tile.block, at);
    vec2 square = mix(cell.xz, cell.yw, clamp(scaled - vec2(at), 0.0, 1.0));
    ivec2 corner = groupCorner(tile, texel, kNearBits) - tile.blockCorner;
    ivec2 found = tile.blockCorner + texelHolding(square, corner, kNearBits, scrambleOf(tile, layer));
    if (!isInChart(chart, found)) return vec3(-1.0);
    Phatexel phatexel = unpackPhatexel(READ(texelFetch(phatexels, ivec3(found, layer), 0).xy));
    return phatexel.valid ? phatexel.radiance : vec3(-1.0);
}

// The radiance of a PHATexel of `layer` toward `direction`; negative where there is none.
vec3 phatexelToward(HitLookup at, vec3 direction, vec4 u, int layer) {
    LookupCursor cursor = at.cursor;
    LookupSample found = findSample(at.query, cursor, direction, u, layer, false);
    if (found.valid) return found.radiance;
    return storedToward(at.query.chart, at.cursor.tile, at.cursor.texel, direction, layer);
}
