// A number in [0, 1] as a colour.

// Black, red, yellow, white: each a third.
vec3 heat(float x) {
    return clamp(3.0 * x - vec3(0.0, 1.0, 2.0), 0.0, 1.0);
}
