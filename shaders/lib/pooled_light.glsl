// Incident light of a traced lobe, between the passes that pool it.
#include "lib/packed_sums.glsl"

struct PooledLight {
    vec3 indirect, area;  // means
    float weight;         // the sum of the rays'; 0: none
    float nearness;       // 1/metres: the mean of what the rays hit
};

uvec4 packPooledLight(PooledLight light) {
    return uvec4(packRgb9e5(light.indirect), packRgb9e5(light.area), floatBitsToUint(light.weight),
                 floatBitsToUint(light.nearness));
}

PooledLight unpackPooledLight(uvec4 bits) {
    return PooledLight(unpackRgb9e5(bits.x), unpackRgb9e5(bits.y), uintBitsToFloat(bits.z), uintBitsToFloat(bits.w));
}
