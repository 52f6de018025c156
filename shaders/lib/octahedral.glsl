// Unit directions as points of the octahedron's unfolded square [-1,1]^2. twin: src/core/base/octahedral.h.

vec3 octahedralToDirection(vec2 folded) {
    vec3 d = vec3(folded, 1.0 - abs(folded.x) - abs(folded.y));
    if (d.z < 0.0)
        d.xy = (1.0 - abs(d.yx)) * vec2(d.x >= 0.0 ? 1.0 : -1.0, d.y >= 0.0 ? 1.0 : -1.0);
    return normalize(d);
}

vec2 octahedralFromDirection(vec3 d) {
    vec2 p = d.xy / (abs(d.x) + abs(d.y) + abs(d.z));
    vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
    return d.z < 0.0 ? folded : p;
}
