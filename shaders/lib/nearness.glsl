// How near a point is to the eye, so that the mean over several pixels is useful: where a bent ray shows in the picture
// depends linearly on it. 1 / meters; for parallel rays, whose `eyeWorld` is the direction toward the eye, -meters.

float nearness(vec3 position, vec3 eyeWorld, float eyeAtInfinity) {
    if (eyeAtInfinity > 0.5) return dot(position, eyeWorld);
    return 1.0 / max(distance(position, eyeWorld), 1e-6);
}

// Meters from `position` to what is straight behind it; negative if that is in front.
float metersBehind(float nearnessBehind, vec3 position, vec3 eyeWorld, float eyeAtInfinity) {
    if (eyeAtInfinity > 0.5) return dot(position, eyeWorld) - nearnessBehind;
    return 1.0 / max(nearnessBehind, 1e-6) - distance(position, eyeWorld);
}
