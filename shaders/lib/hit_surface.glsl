// The surface at a ray's hit, from tables of what the rasteriser reads from vertices and materials.
// twin: surfaceAt in src/core/scene/shading.cpp with means of the textures that are not base colour, emission, metallic
// and roughness, or normals; src/gl/hit_tables.cpp writes the tables.
#include "lib/brdf.glsl"
#include "lib/octahedral.glsl"
#include "lib/table.glsl"

uniform usampler2D hitTable;          // table: materials, then triangles in the order of the leaves, then emitters
uniform int hitFirstTriangle;         // texels
uniform int hitFirstEmitter;
uniform int emitterCount;
uniform sampler2DArray hitColors;     // sRGB: base colours and emission
uniform sampler2DArray hitLinear;     // G roughness, B metallic; or normals

const int kHitMaterialTexels = 5;
const int kHitTriangleTexels = 6;
const int kHitEmitterTexels = 4;
// Flags of a material.
const uint kHitUnlit = 1u;
const uint kHitDoubleSided = 2u;
const uint kHitReadsColors = 4u;  // of vertices, or shines
const uint kHitMirroredU = 16u;
const uint kHitClampedU = 32u;
const uint kHitMirroredV = 64u;
const uint kHitClampedV = 128u;
// Of a triangle, beside its material's number.
const uint kHitGlass = 0x80000000u;
const uint kHitVolume = 0x40000000u;  // glass that light is refracted into
const uint kHitMaterial = 0x3fffffffu;
const uint kNoLayer = 255u;
const uint kHitNoChart = 0xffffffffu;

struct HitSurface {
    vec3 normal;      // shading, on the side that was hit
    Brdf brdf;
    vec3 emission;
    vec2 texel;       // of the atlas
    uint chart;
    uint emitter;     // number + 1; 0: none
};

bool reflects(Brdf brdf) {
    return maxComponent(brdf.diffuseColor + brdf.f0) > 0.0 || brdf.f90 > 0.0;
}

uvec4 hitTexel(int index) {
    return texelFetch(hitTable, tableTexel(index), 0);
}

bool isGlass(int triangle) {
    return hitTexel(hitFirstTriangle + kHitTriangleTexels * triangle + 2).w >= kHitGlass;
}

// Of a vertex, 8 bits a channel.
vec3 colorOf(uint bits) {
    return vec3(float(bits & 255u), float((bits >> 8) & 255u), float((bits >> 16) & 255u)) / 255.0;
}

float wrapped(float u, bool mirrored, bool clamped, float size) {
    if (clamped) return clamp(u, 0.5 / size, 1.0 - 0.5 / size);
    return mirrored ? abs(u - 2.0 * floor(0.5 * u + 0.5)) : u;
}

// `corners`: octahedral; `w`: their weights.
vec3 hitNormal(uvec3 corners, vec3 w) {
    return w.x * octahedralToDirection(unpackSnorm2x16(corners.x)) +
           w.y * octahedralToDirection(unpackSnorm2x16(corners.y)) +
           w.z * octahedralToDirection(unpackSnorm2x16(corners.z));
}

// Normals by a picture; `normal` is the interpolated one. `corners`: the colours, whose upper bytes are the tangent.
vec3 mappedNormal(vec3 texel, float scale, vec3 normal, uvec3 corners) {
    uint code = (corners.x >> 24) | ((corners.y >> 24) << 8) | ((corners.z >> 24) << 16);
    if (code == 0u) return normal;
    vec2 square = vec2(float(code & 2047u), float((code >> 11) & 2047u)) / 1023.0 - 1.0;
    vec3 tangent = octahedralToDirection(square);
    tangent = normalize(tangent - dot(tangent, normal) * normal);
    vec3 bitangent = (float(code >> 22) - 2.0) * cross(normal, tangent), n = 2.0 * texel - 1.0;
    return normalize(n.x * scale * tangent + n.y * scale * bitangent + n.z * normal);
}

// `isShaded`: else the surface is glass as light goes through it, by the interpolated normals, from either side. The back
// of a single-sided material is black where it is shaded. `width`: metres, of what the ray stands for, across it.
HitSurface hitSide(int triangle, vec2 barycentric, bool back, bool isShaded, vec3 towardEye, float width) {
    HitSurface s;
    int first = hitFirstTriangle + kHitTriangleTexels * triangle;
    uvec4 t0 = hitTexel(first), t1 = hitTexel(first + 1), t2 = hitTexel(first + 2), t4 = hitTexel(first + 4);
    vec3 w = vec3(1.0 - barycentric.x - barycentric.y, barycentric);
    s.texel = w.x * uintBitsToFloat(t0.xy) + w.y * uintBitsToFloat(t0.zw) + w.z * uintBitsToFloat(t1.xy);
    s.chart = back ? t1.w : t1.z;
    if (back) s.texel += vec2(ivec2(int(t4.z << 16) >> 16, int(t4.z) >> 16));
    int row = kHitMaterialTexels * int(t2.w & kHitMaterial);
    uvec4 m0 = hitTexel(row), m1 = hitTexel(row + 1), m2 = hitTexel(row + 2), m3 = hitTexel(row + 3);
    uint flags = m3.z;
    s.emitter = 0u;
    s.brdf = Brdf(vec3(0.0), vec3(0.0), 0.0, 1.0, 0.0, kMinAlpha, vec3(0.0, 0.0, 1.0), 0.0, vec3(0.0));
    s.emission = vec3(0.0);
    float side = back ? -1.0 : 1.0;
    s.normal = side * normalize(hitNormal(t2.xyz, w));
    if (back && isShaded && (flags & kHitDoubleSided) == 0u) return s;
    float cosine = dot(s.normal, towardEye);

    vec3 base = uintBitsToFloat(m0.xyz), emission = uintBitsToFloat(m1.xyz);
    float metallic = uintBitsToFloat(m0.w), roughness = uintBitsToFloat(m1.w);
    if ((flags & kHitReadsColors) != 0u) {
        uvec4 t5 = hitTexel(first + 5);
        base *= w.x * colorOf(t5.x) + w.y * colorOf(t5.y) + w.z * colorOf(t5.z);
        s.emitter = t5.w;
    }
    uint layers = m3.w;
    if (layers != 0xffffffffu) {
        uvec4 t3 = hitTexel(first + 3);
        float size = float(textureSize(hitColors, 0).x);
        vec2 uv = w.x * uintBitsToFloat(t3.xy) + w.y * uintBitsToFloat(t3.zw) + w.z * uintBitsToFloat(t4.xy);
        uv = vec2(wrapped(uv.x, (flags & kHitMirroredU) != 0u, (flags & kHitClampedU) != 0u, size),
                  wrapped(uv.y, (flags & kHitMirroredV) != 0u, (flags & kHitClampedV) != 0u, size));
        float level = log2(max(size * unpackHalf2x16(t4.w).x * width / max(cosine, 0.1), 1e-6));
        uint colorLayer = layers & 255u, emissionLayer = (layers >> 8) & 255u, roughnessLayer = (layers >> 16) & 255u,
             normalLayer = layers >> 24;
        if (colorLayer != kNoLayer) base *= textureLod(hitColors, vec3(uv, float(colorLayer)), level).rgb;
        if (emissionLayer != kNoLayer) emission *= textureLod(hitColors, vec3(uv, float(emissionLayer)), level).rgb;
        if (roughnessLayer != kNoLayer) {
            vec3 texel = textureLod(hitLinear, vec3(uv, float(roughnessLayer)), level).rgb;
            roughness *= texel.g;
            metallic *= texel.b;
        }
        if (normalLayer != kNoLayer && isShaded) {
            vec3 texel = textureLod(hitLinear, vec3(uv, float(normalLayer)), level).rgb;
            float scale = unpackHalf2x16(m3.y).y;
            s.normal = side * mappedNormal(texel, scale, side * s.normal, hitTexel(first + 5).xyz);
        }
    }
    cosine = dot(s.normal, towardEye);
    if (cosine < 1e-3) s.normal = normalize(s.normal + (1e-3 - cosine) * towardEye);
    s.emission = emission;
    if ((flags & kHitUnlit) != 0u) return s;
    vec3 dielectricF0 = uintBitsToFloat(m2.xyz);
    float dielectricF90 = uintBitsToFloat(m2.w);
    vec2 coat = unpackHalf2x16(m3.x);
    float transmission = unpackHalf2x16(m3.y).x;
    base = clamp(base, 0.0, 1.0);
    s.brdf.diffuseColor = base * (1.0 - metallic) * (1.0 - meanFresnel(maxComponent(dielectricF0), dielectricF90)) *
                          (1.0 - transmission);
    s.brdf.f0 = mix(dielectricF0, base, metallic);
    s.brdf.f90 = mix(dielectricF90, 1.0, metallic);
    s.brdf.alpha = max(roughness * roughness, kMinAlpha);
    s.brdf.clearcoat = coat.x;
    s.brdf.clearcoatAlpha = max(coat.y * coat.y, kMinAlpha);
    s.brdf.transmission = transmission;
    s.brdf.transmissionColor = transmission * (1.0 - metallic) * base;
    return s;
}

HitSurface hitSurface(int triangle, vec2 barycentric, bool back, vec3 towardEye, float width) {
    return hitSide(triangle, barycentric, back, true, towardEye, width);
}

// A triangle that shines, as a light to be sampled.
struct HitEmitter {
    vec3 a, b, c;       // corners, world
    vec3 radiance;      // mean
    float areaDensity;  // chance to be chosen over area, 1/m2
    bool doubleSided;
};

HitEmitter hitEmitter(int emitter) {
    int first = hitFirstEmitter + kHitEmitterTexels * emitter;
    vec4 e0 = uintBitsToFloat(hitTexel(first)), e1 = uintBitsToFloat(hitTexel(first + 1)),
         e2 = uintBitsToFloat(hitTexel(first + 2)), e3 = uintBitsToFloat(hitTexel(first + 3));
    return HitEmitter(e0.xyz, e1.xyz, e2.xyz, e3.xyz, abs(e3.w), e3.w < 0.0);
}

// Area-preserving. source: Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
// twin: squareToTriangle in src/core/scene/light_emitters.cpp.
vec2 squareToTriangle(vec2 square) {
    if (square.y > square.x) {
        square.x *= 0.5;
        square.y -= square.x;
    } else {
        square.y *= 0.5;
        square.x -= square.y;
    }
    return square;
}

// By Walker's alias table: `choice` in [0,1).
int chooseEmitter(float choice) {
    float scaled = choice * float(emitterCount);
    int column = min(int(scaled), emitterCount - 1);
    int first = hitFirstEmitter + kHitEmitterTexels * column;
    float threshold = uintBitsToFloat(hitTexel(first).w);
    return scaled - float(column) < threshold ? column : int(hitTexel(first + 1).w);
}

// A point of an emitter, as it is seen from elsewhere.
struct EmitterSample {
    vec3 direction;  // unit
    float meters;
    float pdf;       // 1/sr; 0: it does not shine there
    vec3 radiance;
};

// Its point by a random one of the unit square.
vec3 pointOnEmitter(HitEmitter emitter, vec2 square) {
    vec2 on = squareToTriangle(square);
    return mix(emitter.a, emitter.b, on.x) + on.y * (emitter.c - emitter.a);
}

EmitterSample sampleEmitter(HitEmitter emitter, vec2 square, vec3 position) {
    vec3 toward = pointOnEmitter(emitter, square) - position;
    float squared = dot(toward, toward);
    if (!(squared > 0.0)) return EmitterSample(vec3(0.0), 0.0, 0.0, vec3(0.0));
    float meters = sqrt(squared);
    vec3 direction = toward / meters;
    float cosine = -dot(normalize(cross(emitter.b - emitter.a, emitter.c - emitter.a)), direction);
    if (emitter.doubleSided) cosine = abs(cosine);
    return EmitterSample(direction, meters, cosine < 1e-6 ? 0.0 : emitter.areaDensity * squared / cosine, emitter.radiance);
}

// By the power heuristic (Veach 1997), of a sample of density `own` against another technique's.
float powerWeight(float own, float other) {
    float ratio = other / own;
    return 1.0 / (1.0 + ratio * ratio);
}
