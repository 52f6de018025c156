// Equal-area map between the unit square and the hemisphere around +z.
// twin: src/core/base/hemisphere_map.h, with its sources; tests/gl compares the two.

const float kPi = 3.14159265358979;

// Concentric square to unit disk. The two wedges differ by which coordinate is the radius.
vec2 squareToDisk(vec2 square) {
    vec2 s = 2.0 * square - 1.0;
    if (s.x == 0.0 && s.y == 0.0) return vec2(0.0);
    bool xIsRadius = abs(s.x) > abs(s.y);
    float radius = xIsRadius ? s.x : s.y;
    float angle = xIsRadius ? kPi / 4.0 * (s.y / s.x) : kPi / 2.0 - kPi / 4.0 * (s.x / s.y);
    return radius * vec2(cos(angle), sin(angle));
}

vec2 diskToSquare(vec2 disk) {
    float radius = length(disk);
    if (radius == 0.0) return vec2(0.5);
    // Angle from the nearest axis of the wedge, in [-pi/4, pi/4].
    bool xIsRadius = abs(disk.x) > abs(disk.y);
    float along = xIsRadius ? disk.x : disk.y;
    float across = xIsRadius ? disk.y : disk.x;
    float signedRadius = along < 0.0 ? -radius : radius;
    float offset = signedRadius * (4.0 / kPi) * atan(across / along);
    vec2 s = xIsRadius ? vec2(signedRadius, offset) : vec2(offset, signedRadius);
    return 0.5 * (s + 1.0);
}

vec3 squareToHemisphere(vec2 square) {
    vec2 disk = squareToDisk(square);
    float r2 = dot(disk, disk);
    return vec3(disk * sqrt(2.0 - r2), 1.0 - r2);
}

float squareToHemispherePdf(vec3 direction) {
    return direction.z >= 0.0 ? 1.0 / (2.0 * kPi) : 0.0;
}

// pre: |direction| = 1, direction.z >= 0.
vec2 hemisphereToSquare(vec3 direction) {
    return diskToSquare(direction.xy / sqrt(1.0 + direction.z));
}
