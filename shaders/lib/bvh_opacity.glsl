// Whether rays pass surfaces that are masked or blended.
// twin: passesThrough in src/core/scene/ray_opacity.cpp, opacityAt in src/core/scene/shading.h; src/gl/bvh_opacity.cpp
// writes the tables.

uniform usampler2D bvhOpacity;   // table: three texels a transparent triangle, then three a material
uniform sampler2D bvhAlphas;     // table: alpha of the pictures' texels, [y][x]
uniform int bvhFirstTransparent;
uniform int bvhFirstMaterial;    // texel of the first material

const uint kOpacityTexels = 3u;
// Flags of a material.
const uint kWrapMirrored = 1u;
const uint kWrapClamped = 2u;
const uint kNearestTexel = 16u;
const uint kHasPicture = 32u;
const uint kIsMasked = 64u;

struct OpacityMaterial {
    float alpha;
    float cutoff;
    int firstTexel;
    uint flags;
    ivec2 size;
    vec3 rowU, rowV;  // of the texture transform
};

OpacityMaterial opacityMaterial(int material) {
    int first = bvhFirstMaterial + int(kOpacityTexels) * material;
    uvec4 a = texelFetch(bvhOpacity, tableTexel(first), 0);
    uvec4 b = texelFetch(bvhOpacity, tableTexel(first + 1), 0);
    vec4 c = uintBitsToFloat(texelFetch(bvhOpacity, tableTexel(first + 2), 0));
    vec2 offset = uintBitsToFloat(b.zw);
    return OpacityMaterial(uintBitsToFloat(a.x), uintBitsToFloat(a.y), int(a.z), a.w, ivec2(b.xy),
                           vec3(c.xy, offset.x), vec3(c.zw, offset.y));
}

float wrappedCoordinate(float u, uint wrap) {
    if (isnan(u) || isinf(u)) return 0.0;
    return wrap == kWrapClamped ? clamp(u, -1.0, 2.0) : u - 2.0 * floor(0.5 * u);
}

int wrappedTexel(int i, int size, uint wrap) {
    if (wrap == kWrapClamped) return clamp(i, 0, size - 1);
    int period = wrap == kWrapMirrored ? 2 * size : size;
    int m = i - period * int(floor((float(i) + 0.5) / float(period)));
    return m < size ? m : period - 1 - m;
}

float alphaTexel(OpacityMaterial m, int x, int y) {
    int column = wrappedTexel(x, m.size.x, m.flags & 3u), row = wrappedTexel(y, m.size.y, (m.flags >> 2u) & 3u);
    return texelFetch(bvhAlphas, tableTexel(m.firstTexel + row * m.size.x + column), 0).r;
}

float pictureAlpha(OpacityMaterial m, vec2 uv) {
    vec2 at = vec2(dot(m.rowU, vec3(uv, 1.0)), dot(m.rowV, vec3(uv, 1.0)));
    at = vec2(wrappedCoordinate(at.x, m.flags & 3u), wrappedCoordinate(at.y, (m.flags >> 2u) & 3u)) * vec2(m.size);
    if ((m.flags & kNearestTexel) != 0u) return alphaTexel(m, int(floor(at.x)), int(floor(at.y)));
    vec2 corner = floor(at - 0.5), part = at - 0.5 - corner;
    int x = int(corner.x), y = int(corner.y);
    return mix(mix(alphaTexel(m, x, y), alphaTexel(m, x + 1, y), part.x),
               mix(alphaTexel(m, x, y + 1), alphaTexel(m, x + 1, y + 1), part.x), part.y);
}

// 64-bit numbers: low word, high word.

uvec2 product(uint a, uint b) {
    uint aLow = a & 65535u, aHigh = a >> 16u, bLow = b & 65535u, bHigh = b >> 16u;
    uint low = aLow * bLow, cross1 = aHigh * bLow + (low >> 16u), cross2 = aLow * bHigh + (cross1 & 65535u);
    return uvec2((cross2 << 16u) | (low & 65535u), aHigh * bHigh + (cross1 >> 16u) + (cross2 >> 16u));
}

uvec2 times(uvec2 a, uvec2 b) {
    uvec2 low = product(a.x, b.x);
    return uvec2(low.x, low.y + a.x * b.y + a.y * b.x);
}

uvec2 plus(uvec2 a, uvec2 b) {
    uint low = a.x + b.x;
    return uvec2(low, a.y + b.y + (low < a.x ? 1u : 0u));
}

// x ^ (x >> bits), bits in [1, 31].
uvec2 folded(uvec2 x, uint bits) {
    return x ^ uvec2((x.x >> bits) | (x.y << (32u - bits)), x.y >> bits);
}

// twin: src/core/base/random.h.
uvec2 mixBits(uvec2 x) {
    x = times(folded(x, 30u), uvec2(0x1ce4e5b9u, 0xbf58476du));
    x = times(folded(x, 27u), uvec2(0x133111ebu, 0x94d049bbu));
    return folded(x, 31u);
}

// twin: src/core/base/random.h.
uvec2 hashOf(uvec2 a, uvec2 b, uvec2 c) {
    // A loop, so that compilers need not repeat what it does.
    uvec2 hash = uvec2(0x7f4a7c15u, 0x9e3779b9u);
    for (int i = 0; i < 3; ++i) hash = mixBits(plus(hash, i == 0 ? a : i == 1 ? b : c));
    return hash;
}

uvec2 bitsHash(vec3 v) {
    uvec3 bits = floatBitsToUint(v);
    return hashOf(uvec2(bits.x, 0u), uvec2(bits.y, 0u), uvec2(bits.z, 0u));
}

// `triangle`: counted from the first transparent one.
bool passesThrough(int triangle, vec2 barycentric, vec3 origin, vec3 direction) {
    int first = int(kOpacityTexels) * triangle;
    vec4 uv = uintBitsToFloat(texelFetch(bvhOpacity, tableTexel(first), 0));
    uvec4 more = texelFetch(bvhOpacity, tableTexel(first + 1), 0);
    vec3 alphas = uintBitsToFloat(texelFetch(bvhOpacity, tableTexel(first + 2), 0).xyz);
    OpacityMaterial m = opacityMaterial(int(more.w));
    vec3 weights = vec3(1.0 - barycentric.x - barycentric.y, barycentric);
    float opacity = m.alpha * dot(weights, alphas);
    if ((m.flags & kHasPicture) != 0u)
        opacity *= pictureAlpha(m, weights.x * uv.xy + weights.y * uv.zw + weights.z * uintBitsToFloat(more.xy));
    if ((m.flags & kIsMasked) != 0u) return opacity < m.cutoff;
    if (opacity >= 1.0) return false;
    if (opacity <= 0.0) return true;
    uvec2 hash = hashOf(bitsHash(origin), bitsHash(direction), uvec2(more.z, 0u));
    return float(hash.y >> 8u) / 16777216.0 >= opacity;
}
