// Lamps that emit what a photometric file says. Whoever includes this defines vec4 photometryTexel(int index), which
// reads a texel of the table that has the webs.

// A web in the table, and how its lamp is turned. Of each cell of the web's grid, column by column, there is a texel of
// the intensities at its corners, the two of its horizontal angle first. `steps`: of the vertical angle over half a
// turn, of the horizontal one over a whole.
struct PhotometricLamp {
    vec3 direction;       // in which the vertical angle is 0
    vec3 horizontalZero;  // in which the horizontal angle is 0; both unit
    int firstTexel;
    ivec2 steps;
};

// Share of the intensity of its peak, or of what else the table is relative to, in a direction of propagation.
// twin: Photometry::at in src/core/scene/photometry.h.
float photometricFalloff(PhotometricLamp lamp, vec3 direction) {
    const float kHalfTurn = 3.14159265;
    vec2 across = vec2(dot(direction, lamp.horizontalZero), dot(direction, cross(lamp.horizontalZero, lamp.direction)));
    float vertical = atan(length(across), dot(direction, lamp.direction)) * (float(lamp.steps.x) / kHalfTurn);
    int row = clamp(int(vertical), 0, lamp.steps.x - 1);
    float turn = across == vec2(0.0) ? 0.0 : atan(across.y, across.x) / (2.0 * kHalfTurn);
    float horizontal = fract(turn) * float(lamp.steps.y);
    int column = min(int(horizontal), lamp.steps.y - 1);
    vec4 corners = photometryTexel(lamp.firstTexel + column * lamp.steps.x + row);
    vec2 sides = mix(corners.xz, corners.yw, clamp(vertical - float(row), 0.0, 1.0));
    return mix(sides.x, sides.y, horizontal - float(column));
}
