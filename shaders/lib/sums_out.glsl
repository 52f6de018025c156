// The outputs of lookup.frag and pool.frag, a pixel's sums: a layer for the indirect light of the base, with AREA one
// for its area lights, then the same of the coat.
#include "lib/packed_sums.glsl"

layout(location = 0) out uvec4 base;
#ifdef AREA
layout(location = 1) out uvec4 baseArea;
#ifdef CLEARCOAT
layout(location = 2) out uvec4 coat;
layout(location = 3) out uvec4 coatArea;
#endif
const int kLayersPerLobe = 2;
#else
#ifdef CLEARCOAT
layout(location = 1) out uvec4 coat;
#endif
const int kLayersPerLobe = 1;
#endif

// The base, and the coat.
#ifdef CLEARCOAT
const int kLobes = 2;
#else
const int kLobes = 1;
#endif

void writeNothing() {
    base = uvec4(0u);
#ifdef AREA
    baseArea = uvec4(0u);
#endif
#ifdef CLEARCOAT
    coat = uvec4(0u);
#ifdef AREA
    coatArea = uvec4(0u);
#endif
#endif
}

void writeLobe(int lobe, LobeSums d) {
    uvec4 sums = packLobeSums(d);
#ifdef CLEARCOAT
    if (lobe == 1) coat = sums;
    else base = sums;
#else
    base = sums;
#endif
#ifdef AREA
    uvec4 areaSums = packAreaSums(d);
#ifdef CLEARCOAT
    if (lobe == 1) coatArea = areaSums;
    else baseArea = areaSums;
#else
    baseArea = areaSums;
#endif
#endif
}

#ifdef COUNT_READS
// Instead of the weights: reads so far, and by earlier passes.
void addReads(uint indirect, uint area) {
    base.y = indirect + uint(readCount[0]);
#ifdef AREA
    baseArea.y = area + uint(readCount[1]);
#endif
}
#endif
