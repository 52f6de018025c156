// Pass 3: a pixel. Punctual lights by their shadow maps, diffuse light from the irradiance maps, glossy light as the
// lobe's directional albedo times the mean radiance that arrives under it: with LOOKUP the sums that pool.frag left of
// this pixel, else the ratio of the cone-weighted sums of the relit PHATexels. With PAPER indirect light, diffuse and
// glossy, is the mean of what relight_paper.frag made of the PHATexels.
// source: Hensley et al. 2003, sections 6.1 and 6.2; the ratio and the lookup are ours (docs/lookup.md).
#include "lib/contact_shadow.glsl"
#include "lib/fetch.glsl"
#include "lib/irradiance.glsl"
#include "lib/packed_sums.glsl"
#include "lib/paper_cone.glsl"
#include "lib/visible_surface.glsl"
#ifndef WITHOUT_PUNCTUAL_LIGHTS
#include "lib/reflected_lights.glsl"
#endif
#ifdef GLASS
#include "lib/glass.glsl"
#endif
#ifdef GLASS_TEXTURES
#include "lib/behind.glsl"
#endif

#ifdef LOOKUP
// The layers of lib/sums_out.glsl; then, as the bits of floats, the radiance that rays brought, two layers a lobe.
uniform usampler2DArray incident;
uniform int tracedLayer;            // where those begin; 0: there are none
uniform sampler2D tileLight;        // rgb: the bound of the radiance around
#else
uniform sampler2DArray relit;       // lobes: of the indirect light, of area lights, then their coats'
uniform sampler2DArray radii;       // the same lobes, a texel a tile
#endif
uniform vec3 show;                  // direct, glossy indirect, diffuse indirect: 0 or 1
uniform int alphaMode;

#ifdef GLASS
layout(location = 0, index = 0) out vec4 radiance;
layout(location = 0, index = 1) out vec4 transmittance;  // of what is behind
#else
layout(location = 0) out vec4 radiance;  // premultiplied by opacity
#endif

#ifdef GLASS_TEXTURES
uniform sampler2D panes;            // the depth of the nearest glass
uniform usampler2DArray paneLight;  // what rays brought to it, as the bits of floats, two layers a lobe
uniform bool tracesPanes;
uniform bool scatters;  // whether there is a picture of what is behind rough glass
#endif

#ifdef CLEARCOAT
const int kLobes = 2;
#else
const int kLobes = 1;
#endif
const int kIrradianceLobe = kLobes * kSources;  // of relit, with PAPER
// Sources that are ratios of sums.
#ifdef PAPER
const int kFirstSource = 1;
#else
const int kFirstSource = 0;
#endif

// The atlas texel that a pixel shows, and what its lobes have in common.
struct ShownTexel {
    vec2 center;  // texels
    uint chart;
    vec3 radianceBound;
    vec3 irradiance[kSources];
};

// A pixel's radiance by the components of `show`.
struct Components {
    vec3 direct;
    vec3 glossyIndirect;
    vec3 diffuseIndirect;
};

#ifdef LOOKUP
// Lobes below hold too little of the hemisphere to say what its irradiance is; those above, nearly all.
const vec2 kControlAlpha = vec2(0.3, 0.7);
// So far the irradiance of a few samples may be off.
const float kMaxControl = 2.0;

// The albedo of the lobe without colour that lookup.frag samples.
float scalarAlbedo(vec3 albedo) {
    return maxComponent(albedo);
}

// The mean indirect radiance under a lobe. The irradiance that the samples of a broad lobe bring has the same error as
// what the lobe reflects of them; the map's has next to none.
vec3 indirectUnderLobe(LobeSums sums, vec3 irradiance) {
    if (sums.indirect.a <= 0.0) return irradiance / kPi;
    vec3 light = sums.indirect.rgb / sums.indirect.a;
    float bySamples = sums.cosine / sums.indirect.a;
    float times = clamp(luminance(irradiance) / kPi / max(bySamples, 1e-20), 1.0 / kMaxControl, kMaxControl);
    return light * mix(1.0, times, smoothstep(kControlAlpha.x, kControlAlpha.y, sums.alpha));
}

// The mean radiance of a source under a lobe, weighted by the lobe. Where no PHATexel under the lobe is anywhere near,
// the mean over the hemisphere, an approximation. `albedo`: the lobe's, without colour.
vec3 lobeRadiance(int firstLobe, int source, ShownTexel t, float albedo) {
    uvec4 bits = READ(texelFetch(incident, ivec3(gl_FragCoord.xy, firstLobe + source), 0));
    if (source == 0) return indirectUnderLobe(unpackLobeSums(bits), t.irradiance[source]);
    vec3 light = unpackSum(bits.xy).a > 0.0 ? unpackRgb9e5(bits.x) : t.irradiance[source] / kPi;
    // Light samples: what they reflect over the irradiance by the same PHATexels, times the map's, which has no noise.
    return light + luminance(t.irradiance[source]) / max(albedo, 1e-6) * unpackRgb9e5(bits.z);
}

// Traced radiance replaces the lookup's by the weight of traced_weight.glsl.
vec3 tracedOver(vec3 light, int firstLobe, int source) {
    if (tracedLayer == 0) return light;
    int layer = tracedLayer + 2 * (firstLobe / kSources) + source;
    vec4 traced = uintBitsToFloat(texelFetch(incident, ivec3(gl_FragCoord.xy, layer), 0));
    return mix(light, traced.rgb, traced.a);
}

vec3 radianceBoundAt(vec2 center) {
    return READ(texelFetch(tileLight, ivec2(floor(center)) >> 3, 0).rgb);
}
#else
// As texel_material.frag takes a colour's mean.
float scalarAlbedo(vec3 albedo) {
    return dot(albedo, vec3(1.0 / 3.0));
}

vec3 lobeRadiance(int firstLobe, int source, ShownTexel t, float albedo) {
    vec4 sum = lobeSum(relit, radii, firstLobe + source, t.center, t.chart);
    return sum.a > 0.0 ? sum.rgb / sum.a : t.irradiance[source] / kPi;
}

// Of glass traced radiance replaces the pyramid's, in the pixels where it is the nearest.
vec3 tracedOver(vec3 light, int firstLobe, int source) {
#ifdef GLASS_TEXTURES
    if (tracesPanes && texelFetch(panes, ivec2(gl_FragCoord.xy), 0).x == gl_FragCoord.z) {
        int layer = 2 * (firstLobe / kSources) + source;
        vec4 traced = uintBitsToFloat(texelFetch(paneLight, ivec3(gl_FragCoord.xy, layer), 0));
        return mix(light, traced.rgb, traced.a);
    }
#endif
    return light;
}

vec3 radianceBoundAt(vec2 center) {
    return radianceBoundAround(radii, kSources - 1, center);  // the same of all lobes that are drawn
}
#endif

// A clamp: the sources' estimates are independent, and their sum may exceed the brightest light there is, by noise
// alone.
void clampToBound(inout vec3 light[kSources], vec3 bound) {
    vec3 sum = vec3(0.0);
    for (int source = kFirstSource; source < kSources; ++source) sum += light[source];
    vec3 scale = min(vec3(1.0), bound / max(sum, vec3(1e-20)));
    for (int source = kFirstSource; source < kSources; ++source) light[source] *= scale;
}

ShownTexel shownTexel(vec2 center, uint chart) {
    ShownTexel t;
    t.center = center;
    t.chart = chart;
    t.radianceBound = radianceBoundAt(center);
    irradianceAt(center, chart, t.irradiance);
    clampToBound(t.irradiance, kPi * t.radianceBound);
#ifdef PAPER
    t.irradiance[0] = paperMean(relit, kIrradianceLobe, center, chart);
#endif
    return t;
}

// Adds what a lobe of directional albedo `albedo` reflects of each source. `scalar`: the albedo of the lobe alone,
// without colour; `firstLobe`: of the base or of the coat.
void addGlossy(int firstLobe, vec3 albedo, float scalar, ShownTexel t, inout Components c) {
    vec3 light[kSources];
    for (int source = kFirstSource; source < kSources; ++source)
        light[source] = lobeRadiance(firstLobe, source, t, scalar);
    clampToBound(light, t.radianceBound);
    for (int source = kFirstSource; source < kSources; ++source)
        light[source] = tracedOver(light[source], firstLobe, source);
#ifdef PAPER
    // Incident radiance; the caller multiplies it by the albedo in colour.
    light[0] = paperMean(relit, firstLobe, t.center, t.chart) / max(scalar, 1e-6);
#endif
    c.glossyIndirect += albedo * light[0];
#ifdef AREA
    c.direct += albedo * light[1];
#endif
}

// Adds the baked light: indirect light, and direct light of area lights.
void addBakedLight(VisibleSurface s, ViewedBrdf viewed, inout Components c) {
    ShownTexel t = shownTexel(s.texel, s.chart);
    // A loop: drivers inline all functions, and what a lobe needs is long.
    int lobes = viewed.brdf.clearcoat > 0.0 ? kLobes : 1;
    for (int lobe = 0; lobe < lobes; ++lobe) {
        vec3 albedo = viewed.transmission * viewed.specularAlbedo;
        float scalar = scalarAlbedo(viewed.specularAlbedo);
#ifdef CLEARCOAT
        if (lobe == 1) {
            albedo = vec3(1.0 - viewed.transmission);
            scalar = albedo.x / viewed.brdf.clearcoat;
        }
#endif
        if (scalar > 0.0) addGlossy(lobe * kSources, albedo, scalar, t, c);
    }
    vec3 diffuse = viewed.diffuse * unoccludedByThings(vPosition, s.worldFromLocal[2]);
    c.diffuseIndirect = diffuse * t.irradiance[0];
#ifdef AREA
    c.direct += diffuse * t.irradiance[1];
#endif
}

void main() {
    float alpha = alphaMode == 0 ? 1.0 : opacity();
    if (alphaMode == 1) {
        if (alpha < material[3].a) discard;
        alpha = 1.0;
    }
    vec4 rows[kFactorRows];
    for (int i = 0; i < kFactorRows; ++i) rows[i] = material[i];
    MaterialFactors factors = unpackFactors(rows);

    vec3 emission = factors.emission * texture(emissionTexture, slotUv(kSlotEmission)).rgb;
    if (factors.unlit) {
        radiance = vec4(emission * vColor.rgb * show.x * alpha, alpha);
        return;
    }

    VisibleSurface s = visibleSurface(factors);
#ifdef GLASS
    transmittance = vec4(1.0 - alpha + alpha * glassTransmittance(factors, s), 1.0);
#endif
    ViewedBrdf viewed = viewedBrdf(s.brdf, s.towardEyeLocal);
    Components c = Components(emission, vec3(0.0), vec3(0.0));
#ifndef WITHOUT_PUNCTUAL_LIGHTS
    addPunctualLights(s, viewed, c.direct);
#endif
    if (s.chart != kNoChart) addBakedLight(s, viewed, c);
    vec3 sum = c.direct * show.x + c.glossyIndirect * show.y + c.diffuseIndirect * show.z;
    // A broken vertex or texel must not spread over the picture.
    if (any(isnan(sum)) || any(isinf(sum))) sum = vec3(0.0);
    radiance = vec4(sum * alpha, alpha);
#ifdef GLASS
    radiance.a = 0.0;
#endif
#ifdef GLASS_TEXTURES
    float scattering = glassScatteringAlpha(factors, s.brdf);
    if (scatters && scattering > kMinAlpha) {
        radiance.rgb += (transmittance.rgb - (1.0 - alpha)) * scatteredBehind(s, scattering);
        transmittance = vec4(1.0 - alpha);
    }
#endif
#if defined(COUNT_READS) && defined(LOOKUP)
    radiance = vec4(0.0, 0.0, 0.0, 1.0);
    for (int i = 0; i < kSources; ++i)
        radiance[i] = float(texelFetch(incident, ivec3(gl_FragCoord.xy, i), 0).y) + float(readCount[i]);
#endif
}
