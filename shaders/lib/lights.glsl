// Punctual lights and their shadow maps.
// twin: LightSampler::samplePunctual in src/core/scene/lights.h; src/gl/shadow_maps.cpp writes the table.
#include "lib/table.glsl"

const int kLightRows = 4;
const int kShadowRows = 4;
const int kLightPoint = 0;
const int kLightSpot = 1;
const int kLightDirectional = 2;

// A light's rows: (position, type), (intensity, range), (direction, cosInner), (cosOuter, first shadow layer,
// layer count, least squared distance). After all lights, the columns of each shadow layer's clipFromWorld.
uniform sampler2D lightTable;
uniform sampler2DArrayShadow shadowMaps;
uniform int lightCount;
#ifdef SHADOW_TINTS
uniform sampler2DArray shadowTints;  // rgb: what all glass on the way lets through; a: the depth of the nearest
#endif

struct PunctualSample {
    vec3 towardLight;
    vec3 irradiance;  // W/m2 on a plane facing the light
    float distance;
};

vec4 lightRow(int light, int row) {
    return texelFetch(lightTable, tableTexel(light * kLightRows + row), 0);
}

// source: KHR_lights_punctual, for the fall-off by range and by cone.
PunctualSample samplePunctual(int light, vec3 point) {
    vec4 positionType = lightRow(light, 0);
    vec4 intensityRange = lightRow(light, 1);
    int type = int(positionType.w);
    if (type == kLightDirectional) return PunctualSample(-lightRow(light, 2).xyz, intensityRange.rgb, 1e30);

    vec3 offset = positionType.xyz - point;
    float d2 = max(dot(offset, offset), lightRow(light, 3).w);
    float d = sqrt(d2);
    vec3 towardLight = offset / d;
    float attenuation = 1.0 / d2;
    if (intensityRange.w > 0.0) {
        float r2 = d2 / (intensityRange.w * intensityRange.w);
        attenuation *= clamp(1.0 - r2 * r2, 0.0, 1.0);
    }
    if (type == kLightSpot) {
        vec4 directionInner = lightRow(light, 2);
        float cosOuter = lightRow(light, 3).x;
        float cosine = dot(-towardLight, directionInner.xyz);
        float cone = clamp((cosine - cosOuter) / max(directionInner.w - cosOuter, 1e-3), 0.0, 1.0);
        attenuation *= cone * cone;
    }
    return PunctualSample(towardLight, intensityRange.rgb * attenuation, d);
}

mat4 shadowClipFromWorld(int layer, int firstRow) {
    int row = firstRow + layer * kShadowRows;
    return mat4(texelFetch(lightTable, tableTexel(row), 0), texelFetch(lightTable, tableTexel(row + 1), 0),
                texelFetch(lightTable, tableTexel(row + 2), 0), texelFetch(lightTable, tableTexel(row + 3), 0));
}

// Visibility of the light, by 4x4 depth comparisons under a 3x3 box that moves with the point.
//
// Every comparison is made against the receiver's own plane, extended under the tap (Isidoro 2006, "Shadow
// Mapping: GPU-based Tips and Techniques"), so that a flat surface neither shadows itself nor needs an offset
// that would detach the shadow where things touch.
float shadowLayerVisibility(int layer, int firstRow, vec3 point, vec3 normalGeometric) {
    mat4 clipFromWorld = shadowClipFromWorld(layer, firstRow);
    vec4 clip = clipFromWorld * vec4(point, 1.0);
    if (clip.w <= 0.0) return 1.0;
    vec3 ndc = clip.xyz / clip.w;
    if (any(greaterThan(abs(ndc), vec3(1.0)))) return 1.0;

    // The plane's depth as a function of the map's x and y: d(ndc) along two tangents.
    vec3 t = abs(normalGeometric.y) < 0.9 ? cross(normalGeometric, vec3(0.0, 1.0, 0.0))
                                          : cross(normalGeometric, vec3(1.0, 0.0, 0.0));
    vec4 alongT = clipFromWorld * vec4(t, 0.0);
    vec4 alongB = clipFromWorld * vec4(cross(normalGeometric, t), 0.0);
    vec3 dT = alongT.xyz - ndc * alongT.w;
    vec3 dB = alongB.xyz - ndc * alongB.w;
    float determinant = dT.x * dB.y - dT.y * dB.x;
    // Seen edge on, the plane has no depth of its own in the map; such a point receives next to nothing.
    if (abs(determinant) < 1e-6 * (length(dT) * length(dB))) return 0.0;
    vec2 slope = vec2(dT.z * dB.y - dB.z * dT.y, dB.z * dT.x - dT.z * dB.x) / determinant;

    float size = float(textureSize(shadowMaps, 0).x);
    vec2 texel = (0.5 * ndc.xy + 0.5) * size;
    vec2 corner = floor(texel - 0.5);
    vec2 f = texel - 0.5 - corner;
    // Half a texel of slope covers triangles that meet at an angle; the rest is rounding.
    float bias = 1e-6 + 0.5 * (abs(slope.x) + abs(slope.y)) / size;

    float lit = 0.0;
    for (int y = 0; y < 4; ++y) {
        float weightY = y == 0 ? 1.0 - f.y : y == 3 ? f.y : 1.0;
        for (int x = 0; x < 4; ++x) {
            float weightX = x == 0 ? 1.0 - f.x : x == 3 ? f.x : 1.0;
            vec2 tap = corner + vec2(float(x) - 0.5, float(y) - 0.5);
            float depth = ndc.z + dot(slope, (tap - texel) * (2.0 / size));
            lit += weightX * weightY *
                   texture(shadowMaps, vec4(tap / size, float(layer), 0.5 * depth + 0.5 - bias));
        }
    }
    return lit / 9.0;
}

#ifdef SHADOW_TINTS
// Where there is more than one glass, also a point between them receives what all of them let through.
vec3 shadowTint(int layer, int firstRow, vec3 point) {
    mat4 clipFromWorld = shadowClipFromWorld(layer, firstRow);
    vec4 clip = clipFromWorld * vec4(point, 1.0);
    vec3 ndc = clip.xyz / clip.w;
    if (clip.w <= 0.0 || any(greaterThan(abs(ndc), vec3(1.0)))) return vec3(1.0);
    ivec2 last = textureSize(shadowTints, 0).xy - 1;
    vec2 texel = (0.5 * ndc.xy + 0.5) * vec2(last + 1) - 0.5;
    vec2 corner = floor(texel), t = texel - corner;
    // A glass does not lie before itself.
    float depth = 0.5 * ndc.z + 0.5 - 1e-5;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 side = ivec2(i & 1, i >> 1);
        vec4 tap = texelFetch(shadowTints, ivec3(clamp(ivec2(corner) + side, ivec2(0), last), layer), 0);
        float weight = (side.x == 1 ? t.x : 1.0 - t.x) * (side.y == 1 ? t.y : 1.0 - t.y);
        sum += weight * (tap.a < depth ? tap.rgb : vec3(1.0));
    }
    return sum;
}
#endif

vec3 shadowVisibility(int light, vec3 point, vec3 normalGeometric) {
    vec4 row = lightRow(light, 3);
    int layer = int(row.y);
    if (row.z > 1.5) {
        // Faces +x -x +y -y +z -z, by the largest coordinate.
        vec3 d = point - lightRow(light, 0).xyz;
        vec3 a = abs(d);
        if (a.x >= a.y && a.x >= a.z) layer += d.x > 0.0 ? 0 : 1;
        else if (a.y >= a.z) layer += d.y > 0.0 ? 2 : 3;
        else layer += d.z > 0.0 ? 4 : 5;
    }
    vec3 visibility = vec3(shadowLayerVisibility(layer, lightCount * kLightRows, point, normalGeometric));
#ifdef SHADOW_TINTS
    if (visibility.x > 0.0) visibility *= shadowTint(layer, lightCount * kLightRows, point);
#endif
    return visibility;
}
