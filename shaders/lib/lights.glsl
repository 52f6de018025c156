// Punctual lights and their shadow maps.
// twin: LightSampler::samplePunctual in src/core/scene/lights.h; src/gl/shadow_maps.cpp writes the table.
#include "lib/table.glsl"

const int kLightRows = 5;
const int kShadowRows = 4;
const int kLightPoint = 0;
const int kLightSpot = 1;
const int kLightDirectional = 2;

// A light's rows: (position, type), (intensity, range), (direction, cosInner), (cosOuter, first shadow layer,
// layer count, w). The range of a directional light is the radius of its disc in radians. w of a directional light:
// radius in texels of the shadow of a disc's light at the map's whole depth, 0 where it is no disc; of others: the least
// squared distance. The last row: (where the horizontal angle of its photometry is 0, first texel of the photometry's
// table), 0 where the light has none; where it has one, cosInner and cosOuter are the steps of the table over half a
// turn of the vertical and a whole one of the horizontal angle. After all lights, the columns of each shadow layer's
// clipFromWorld; after these, the photometries' tables (lib/photometry.glsl).
uniform sampler2D lightTable;
uniform sampler2DArrayShadow shadowMaps;
uniform int lightCount;
#ifdef SUN_DISC
uniform sampler2DArray shadowDepths;  // the maps without comparison
#endif
#ifdef SHADOW_TINTS
uniform sampler2DArray shadowTints;  // rgb: what all glass on the way lets through; a: the depth of the nearest
#endif

// twin: kMinConeWidth in src/core/scene/light_punctual.cpp.
const float kMinConeWidth = 2e-7;

struct PunctualSample {
    vec3 towardLight;
    vec3 irradiance;  // W/m2 on a plane facing the light
    float distance;
    float discRadius;  // radians
};

vec4 lightRow(int light, int row) {
    return texelFetch(lightTable, tableTexel(light * kLightRows + row), 0);
}

vec4 photometryTexel(int index) {
    return texelFetch(lightTable, tableTexel(index), 0);
}
#include "lib/photometry.glsl"

// source: KHR_lights_punctual, for the fall-off by range and by cone.
PunctualSample samplePunctual(int light, vec3 point) {
    vec4 positionType = lightRow(light, 0);
    vec4 intensityRange = lightRow(light, 1);
    int type = int(positionType.w);
    if (type == kLightDirectional)
        return PunctualSample(-lightRow(light, 2).xyz, intensityRange.rgb, 1e30, intensityRange.w);

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
        float cone = clamp((cosine - cosOuter) / max(directionInner.w - cosOuter, kMinConeWidth), 0.0, 1.0);
        attenuation *= cone * cone;
    }
    vec4 zero = lightRow(light, 4);
    if (zero.w > 0.0) {
        vec4 axis = lightRow(light, 2);
        ivec2 steps = ivec2(axis.w, lightRow(light, 3).x);
        attenuation *= photometricFalloff(PhotometricLamp(axis.xyz, zero.xyz, int(zero.w), steps), -towardLight);
    }
    return PunctualSample(towardLight, intensityRange.rgb * attenuation, d, 0.0);
}

mat4 shadowClipFromWorld(int layer, int firstRow) {
    int row = firstRow + layer * kShadowRows;
    return mat4(texelFetch(lightTable, tableTexel(row), 0), texelFetch(lightTable, tableTexel(row + 1), 0),
                texelFetch(lightTable, tableTexel(row + 2), 0), texelFetch(lightTable, tableTexel(row + 3), 0));
}

// A point in a layer of the shadow maps, with its surface's plane: every comparison is made against the plane,
// extended under the tap (Isidoro 2006, "Shadow Mapping: GPU-based Tips and Techniques"), so that a flat surface
// neither shadows itself nor needs an offset that would detach the shadow where things touch.
struct ShadowReceiver {
    int layer;
    float size;   // of the map, texels
    vec2 texel;   // of the point
    float depth;  // 0 to 1, as in the map
    vec2 slope;   // of the plane's depth, per texel
    float bias;
};

// What the receiver is lit by without any map: 1 outside of them; 0 where the plane is seen edge on and receives next
// to nothing; else -1.
float shadowReceiver(int layer, int firstRow, vec3 point, vec3 normalGeometric, out ShadowReceiver r) {
    r = ShadowReceiver(layer, float(textureSize(shadowMaps, 0).x), vec2(0.0), 0.0, vec2(0.0), 0.0);
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
    if (abs(determinant) < 1e-6 * (length(dT) * length(dB))) return 0.0;
    vec2 slope = vec2(dT.z * dB.y - dB.z * dT.y, dB.z * dT.x - dT.z * dB.x) / determinant;

    r.texel = (0.5 * ndc.xy + 0.5) * r.size;
    r.depth = 0.5 * ndc.z + 0.5;
    r.slope = slope / r.size;
    // Half a texel of slope covers triangles that meet at an angle; the rest is rounding.
    r.bias = 1e-6 + 0.5 * (abs(r.slope.x) + abs(r.slope.y));
    return -1.0;
}

// Visibility of a point of light, by 4x4 depth comparisons under a 3x3 box that moves with the point.
float boxVisibility(ShadowReceiver r) {
    ivec2 first = ivec2(floor(r.texel - 0.5)) - 1;
    vec2 f = r.texel - 1.5 - vec2(first);
    float lit = 0.0;
    // Rows are a loop whose bounds compilers do not know, so that the code of only one is there.
    for (int y = first.y; y <= first.y + 3; ++y) {
        float weightY = y == first.y ? 1.0 - f.y : y == first.y + 3 ? f.y : 1.0;
        for (int x = 0; x < 4; ++x) {
            float weightX = x == 0 ? 1.0 - f.x : x == 3 ? f.x : 1.0;
            vec2 tap = vec2(first.x + x, y) + 0.5;
            float depth = r.depth + dot(r.slope, tap - r.texel);
            lit += weightX * weightY * texture(shadowMaps, vec4(tap / r.size, float(r.layer), depth - r.bias));
        }
    }
    return lit / 9.0;
}

#ifdef SUN_DISC
// How far before the receiver's plane a texel's surface is, of the map's depth; 0: not before it, or so near that
// none of the disc is behind it as the receiver sees it. `disc`: see the light's rows.
float casterDepth(ShadowReceiver r, ivec2 texel, float disc) {
    vec2 offset = vec2(texel) + 0.5 - r.texel;
    ivec2 last = ivec2(int(r.size) - 1);
    float depth = texelFetch(shadowDepths, ivec3(clamp(texel, ivec2(0), last), r.layer), 0).r;
    float before = r.depth + dot(r.slope, offset) - depth;
    return before > r.bias && length(offset) <= disc * before + 0.75 ? before : 0.0;
}

// The fraction of a disc that is seen: the texels that cast a shadow, by the mean distance of the casters, over those
// of a disc of that size (Fernando 2005, "Percentage-Closer Soft Shadows"). Of one straight edge the fraction is
// exact but for the texels. `box`: boxVisibility, which is what is left where the disc's shadow is no larger than that.
float discVisibility(ShadowReceiver r, float disc, float box) {
    const int kSearch = 4;  // places on either side
    float reach = disc * r.depth, sum = 0.0;
    int casters = 0, places = 0;
    for (int y = -kSearch; y <= kSearch; ++y) {
        for (int x = -kSearch; x <= kSearch; ++x) {
            if (x * x + y * y > kSearch * kSearch) continue;
            vec2 offset = vec2(x, y) * (reach / float(kSearch));
            float before = casterDepth(r, ivec2(floor(r.texel + offset)), disc);
            sum += before;
            casters += before > 0.0 ? 1 : 0;
            ++places;
        }
    }
    if (casters == 0) return box;
    if (casters == places && box == 0.0) return 0.0;
    const float kBoxRadius = 1.5;
    float radius = min(disc * sum / float(casters), reach);
    if (radius <= kBoxRadius) return box;
    ivec2 low = ivec2(floor(r.texel - radius - 0.5)), high = ivec2(floor(r.texel + radius + 0.5));
    float lit = 0.0, all = 0.0;
    for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
            float weight = clamp(radius + 0.5 - distance(vec2(x, y) + 0.5, r.texel), 0.0, 1.0);
            if (weight <= 0.0) continue;
            all += weight;
            if (casterDepth(r, ivec2(x, y), disc) <= 0.0) lit += weight;
        }
    }
    return mix(box, lit / all, min(radius - kBoxRadius, 1.0));
}
#endif

float shadowLayerVisibility(int layer, int firstRow, vec3 point, vec3 normalGeometric, float disc) {
    ShadowReceiver r;
    float known = shadowReceiver(layer, firstRow, point, normalGeometric, r);
    if (known >= 0.0) return known;
    float box = boxVisibility(r);
#ifdef SUN_DISC
    if (disc > 0.0) return discVisibility(r, disc, box);
#endif
    return box;
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
    ivec2 corner = ivec2(floor(texel));
    vec2 t = texel - vec2(corner);
    // A glass does not lie before itself.
    float depth = 0.5 * ndc.z + 0.5 - 1e-5;
    vec3 sum = vec3(0.0);
    for (int y = corner.y; y <= corner.y + 1; ++y) {
        for (int x = corner.x; x <= corner.x + 1; ++x) {
            vec4 tap = texelFetch(shadowTints, ivec3(clamp(ivec2(x, y), ivec2(0), last), layer), 0);
            float weight = (x == corner.x ? 1.0 - t.x : t.x) * (y == corner.y ? 1.0 - t.y : t.y);
            sum += weight * (tap.a < depth ? tap.rgb : vec3(1.0));
        }
    }
    return sum;
}
#endif

// Of the maps of a light, the one that `point` is in. `row`: the light's last.
int shadowLayerAt(int light, vec4 row, vec3 point) {
    int layer = int(row.y);
    if (row.z < 1.5) return layer;
    // Faces +x -x +y -y +z -z, by the largest coordinate.
    vec3 d = point - lightRow(light, 0).xyz;
    vec3 a = abs(d);
    if (a.x >= a.y && a.x >= a.z) return layer + (d.x > 0.0 ? 0 : 1);
    if (a.y >= a.z) return layer + (d.y > 0.0 ? 2 : 3);
    return layer + (d.z > 0.0 ? 4 : 5);
}

vec3 shadowVisibility(int light, vec3 point, vec3 normalGeometric) {
    vec4 row = lightRow(light, 3);
    int layer = shadowLayerAt(light, row, point);
    float disc = int(lightRow(light, 0).w) == kLightDirectional ? row.w : 0.0;
    vec3 visibility = vec3(shadowLayerVisibility(layer, lightCount * kLightRows, point, normalGeometric, disc));
#ifdef SHADOW_TINTS
    if (visibility.x > 0.0) visibility *= shadowTint(layer, lightCount * kLightRows, point);
#endif
    return visibility;
}

// By one comparison, for points that no pixel shows.
float hardShadow(int light, vec3 point, vec3 normalGeometric) {
    ShadowReceiver r;
    float known = shadowReceiver(shadowLayerAt(light, lightRow(light, 3), point), lightCount * kLightRows, point,
                                 normalGeometric, r);
    if (known >= 0.0) return known;
    return texture(shadowMaps, vec4(r.texel / r.size, float(r.layer), r.depth - 2.0 * r.bias));
}
