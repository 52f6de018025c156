// The glTF 2.0 material model. All directions are unit, local (z = shading normal) and point away from the
// surface.
// twin: src/core/scene/brdf.h, same names and sources; tests/gl compares the two.
#include "lib/hemisphere_map.glsl"

const float kMinAlpha = 1e-3;
const float kClearcoatF0 = 0.04;

struct Brdf {
    vec3 diffuseColor;
    vec3 f0;
    float f90;
    float alpha;
    float clearcoat;
    float clearcoatAlpha;
    vec3 clearcoatNormal;  // local
    float transmission;
    vec3 transmissionColor;
};

struct LobeValues {
    vec3 diffuse;
    vec3 specular;
};

// 64x64 over (nDotV, sqrt(alpha)), two channels, entry i at i / 63: core's splitSumTable().
uniform sampler2D splitSumTable;

// twin: luminance in src/core/base/math.h.
float luminance(vec3 rgb) {
    return dot(rgb, vec3(0.2126, 0.7152, 0.0722));
}

float maxComponent(vec3 v) {
    return max(v.x, max(v.y, v.z));
}

float ggxD(float nDotH, float alpha) {
    float a2 = alpha * alpha;
    float d = (nDotH * a2 - nDotH) * nDotH + 1.0;
    return a2 / (kPi * d * d);
}

float smithV(float nDotL, float nDotV, float alpha) {
    float a2 = alpha * alpha;
    float eye = nDotL * sqrt(nDotV * nDotV * (1.0 - a2) + a2);
    float light = nDotV * sqrt(nDotL * nDotL * (1.0 - a2) + a2);
    return 0.5 / max(eye + light, 1e-7);
}

float smithG1(float nDotV, float alpha) {
    float a2 = alpha * alpha;
    return 2.0 * nDotV / (nDotV + sqrt(nDotV * nDotV * (1.0 - a2) + a2));
}

// What a direction `wi` that was drawn from a lobe's visible normals stands for: f cos over its density, less Fresnel's term.
// source: Heitz 2018, section 4: G2 / G1.
float visibleNormalWeight(vec3 wi, vec3 wo, float alpha) {
    return wi.z <= 0.0 ? 0.0 : smithV(wi.z, wo.z, alpha) * 4.0 * wi.z * wo.z / smithG1(wo.z, alpha);
}

vec3 schlick(vec3 f0, float f90, float vDotH) {
    float m = clamp(1.0 - vDotH, 0.0, 1.0);
    return f0 + (vec3(f90) - f0) * (m * m * m * m * m);
}

vec2 splitSum(float nDotV, float alpha) {
    // Bilinear by hand: GPUs filter with 8-bit weights, which is visible as steps of 0.3 %.
    vec2 last = vec2(textureSize(splitSumTable, 0) - 1);
    vec2 at = clamp(vec2(nDotV, sqrt(alpha)), 0.0, 1.0) * last;
    vec2 corner = min(floor(at), last - 1.0);
    ivec2 c = ivec2(corner);
    vec2 t = at - corner;
    vec2 low = mix(texelFetch(splitSumTable, c, 0).rg, texelFetch(splitSumTable, c + ivec2(1, 0), 0).rg, t.x);
    vec2 high = mix(texelFetch(splitSumTable, c + ivec2(0, 1), 0).rg,
                    texelFetch(splitSumTable, c + ivec2(1, 1), 0).rg, t.x);
    return mix(low, high, t.y);
}

vec3 specularAlbedo(vec3 f0, float f90, float alpha, float nDotV) {
    vec2 ab = splitSum(nDotV, alpha);
    return f0 * ab.x + vec3(f90 * ab.y);
}

float diffuseWeight(Brdf brdf, float nDotV) {
    float brightest = maxComponent(brdf.diffuseColor);
    if (brightest <= 0.0) return 1.0;
    if (brdf.transmission > 0.0 && brdf.transmission < 1.0) brightest /= 1.0 - brdf.transmission;
    float left = 1.0 - maxComponent(specularAlbedo(brdf.f0, brdf.f90, brdf.alpha, nDotV));
    return clamp(left / brightest, 0.0, 1.0);
}

float clearcoatTransmission(Brdf brdf, vec3 towardEye) {
    if (brdf.clearcoat <= 0.0) return 1.0;
    float cosine = max(dot(towardEye, brdf.clearcoatNormal), 0.0);
    vec2 ab = splitSum(cosine, brdf.clearcoatAlpha);
    return 1.0 - brdf.clearcoat * (kClearcoatF0 * ab.x + ab.y);
}

vec3 interfaceTransmittance(Brdf brdf, vec3 towardEye) {
    float reflected = maxComponent(specularAlbedo(brdf.f0, brdf.f90, brdf.alpha, towardEye.z));
    return clearcoatTransmission(brdf, towardEye) * max(1.0 - reflected, 0.0) * brdf.transmissionColor;
}

// A BRDF for one direction toward the eye, with the terms that depend on that direction alone.
struct ViewedBrdf {
    Brdf brdf;
    vec3 towardEye;
    float transmission;   // of the coat
    vec3 diffuse;         // Lambert's f, 1/sr
    vec3 specularAlbedo;  // of GGX, as if there were no coat
};

ViewedBrdf viewedBrdf(Brdf brdf, vec3 towardEye) {
    float transmission = clearcoatTransmission(brdf, towardEye);
    vec3 albedo = specularAlbedo(brdf.f0, brdf.f90, brdf.alpha, towardEye.z);
    vec3 diffuse = transmission * diffuseWeight(brdf, towardEye.z) * brdf.diffuseColor / kPi;
    return ViewedBrdf(brdf, towardEye, transmission, diffuse, albedo);
}

// Lobes from so many times a disc's radius on show its light as if it came from the disc's middle; the highlight's peak is
// 6 % too bright there. Those narrower than the disc show the disc.
const float kWiderThanDisc = 4.0;

// ggxD, or its mean over the half vectors toward a disc of `discRadius` radians around the light. By slope GGX is the area
// of the sphere under stereographic projection, which maps circles to circles: what lies in a disc is the area of a cap.
// The lobe counts as round here, with the width of one of equal area. ours.
float discD(float nDotH, float vDotH, float alpha, vec3 mirror, vec3 towardLight, float discRadius) {
    float middle = ggxD(nDotH, alpha);
#ifdef SUN_DISC
    float width = 2.0 * alpha * sqrt(vDotH);  // radians, around the mirror direction
    if (width >= kWiderThanDisc * discRadius) return middle;
    vec3 apart = mirror - towardLight;
    float r2 = discRadius * discRadius, b = width * width + dot(apart, apart) - r2;
    // Of the cap's half angle: tan = 2 r width / b.
    float opposite = 4.0 * r2 * width * width, hypotenuse = b * b + opposite;
    float cosine = b * inversesqrt(hypotenuse);
    float cap = cosine > 0.0 ? 0.5 * opposite / hypotenuse / (1.0 + cosine) : 0.5 - 0.5 * cosine;
    float disc = 4.0 * vDotH * cap / (kPi * r2);
    return mix(disc, middle, smoothstep(1.0, kWiderThanDisc, width / discRadius));
#else
    return middle;
#endif
}

// BRDF * cos by lobe: Lambert, and GGX with the coat. `discRadius`: of the light, radians.
LobeValues evaluateLobes(ViewedBrdf viewed, vec3 towardLight, float discRadius) {
    LobeValues value = LobeValues(vec3(0.0), vec3(0.0));
    Brdf brdf = viewed.brdf;
    vec3 towardEye = viewed.towardEye;
    if (towardEye.z <= 0.0 || towardLight.z <= 0.0) return value;

    vec3 h = normalize(towardEye + towardLight);
    float vDotH = dot(towardEye, h);
    value.diffuse = viewed.diffuse * towardLight.z;
    vec3 mirror = vec3(-towardEye.xy, towardEye.z);
    value.specular = viewed.transmission * discD(h.z, vDotH, brdf.alpha, mirror, towardLight, discRadius) *
                     smithV(towardLight.z, towardEye.z, brdf.alpha) * towardLight.z *
                     schlick(brdf.f0, brdf.f90, vDotH);
    if (brdf.clearcoat > 0.0) {
        float nDotV = dot(towardEye, brdf.clearcoatNormal);
        float nDotL = dot(towardLight, brdf.clearcoatNormal);
        if (nDotV > 0.0 && nDotL > 0.0) {
            float nDotH = dot(h, brdf.clearcoatNormal);
            mirror = reflect(-towardEye, brdf.clearcoatNormal);
            value.specular += brdf.clearcoat *
                              discD(nDotH, vDotH, brdf.clearcoatAlpha, mirror, towardLight, discRadius) *
                              smithV(nDotL, nDotV, brdf.clearcoatAlpha) * nDotL *
                              schlick(vec3(kClearcoatF0), 1.0, vDotH);
        }
    }
    return value;
}

LobeValues evaluateLobes(ViewedBrdf viewed, vec3 towardLight) {
    return evaluateLobes(viewed, towardLight, 0.0);
}

vec3 evaluateBrdf(ViewedBrdf viewed, vec3 towardLight, float discRadius) {
    LobeValues value = evaluateLobes(viewed, towardLight, discRadius);
    return value.diffuse + value.specular;
}

vec3 evaluateBrdf(ViewedBrdf viewed, vec3 towardLight) {
    return evaluateBrdf(viewed, towardLight, 0.0);
}

const float kMeanSchlick = 0.00368;

float meanFresnel(float f0, float f90) {
    return f0 + (f90 - f0) * kMeanSchlick;
}
