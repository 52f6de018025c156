// Random numbers of texels.

// Three numbers in [0,1). source: pcg3d of Jarzynski and Olano 2020, "Hash Functions for GPU Rendering".
vec3 randomNumbers(uvec3 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return vec3(v >> 8) * exp2(-24.0);
}
