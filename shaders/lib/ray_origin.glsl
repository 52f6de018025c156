// Where a ray from a surface begins.

// A length unit of the scene's own, metres: Atlas::unitMeters.
uniform float originUnitMeters;

// `position`, which the eye sees, moved off its surface, so that rays on the side of `normal` do not meet it again; and
// toward the eye, so that it is not behind another surface that it touches.
// source: Waechter and Binder 2019, "A Fast and Robust Method for Avoiding Self-Intersection"; toward the eye is ours.
// twin: offsetOrigin in src/core/scene/rays.cpp, but by steps of at least 2^-16 units: positions here were interpolated.
vec3 offsetOrigin(vec3 position, vec3 normal, vec3 towardEye) {
    vec3 steps = max(abs(position) * (256.0 / 8388608.0), vec3(originUnitMeters / 65536.0));
    return position + steps * (normal + towardEye);
}
