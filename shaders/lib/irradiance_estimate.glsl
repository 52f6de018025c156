// The irradiance of a texel as the mean of its samples so far.

struct IrradianceEstimate {
    vec3 mean;        // W/m2
    float count;      // of samples; 0: none
    float statistic;  // area lights: root of the mean square of luminances; indirect: mean of texel size over distance
};

IrradianceEstimate unpackEstimate(uvec4 bits) {
    vec2 halves = unpackHalf2x16(bits.w);
    return IrradianceEstimate(uintBitsToFloat(bits.xyz), halves.x, halves.y);
}

uvec4 packEstimate(IrradianceEstimate e) {
    return uvec4(floatBitsToUint(e.mean), packHalf2x16(vec2(e.count, min(e.statistic, 65504.0))));
}
