// Pass 3: a pixel. Direct light by the lamps' shadow maps, diffuse light from the irradiance maps, glossy light
// as the lobe's directional albedo times what the lobe sees: with LOOKUP what pool.frag left of this pixel, else the
// ratio of the cone-weighted sums of the relit PHATexels. With PAPER indirect light, diffuse and glossy, is the mean of
// what relight_paper.frag made of the PHATexels.
// source: Hensley et al. 2003, sections 6.1 and 6.2; the ratio and the lookup are ours (docs/lookup.md).
#include "lib/fetch.glsl"
#include "lib/packed_draws.glsl"
#include "lib/paper_cone.glsl"
#include "lib/visible_surface.glsl"
#include "lib/lights.glsl"

#ifdef LOOKUP
uniform usampler2DArray seen;       // see lib/draws_out.glsl; then floats' bits: what rays saw, two layers a lobe
uniform int tracedLayer;            // where those begin; 0: there are none
uniform sampler2D tileLight;        // rgb: the brightest radiance around
#else
uniform sampler2DArray relit;       // lobes: of the indirect light, of area lights, then their coats'
uniform sampler2DArray radii;       // the same lobes, a texel a tile
#endif
uniform sampler2DArray irradiance;  // 0 indirect, 1 area lights
uniform vec3 show;                  // direct, glossy indirect, diffuse indirect: 0 or 1
uniform int alphaMode;

layout(location = 0) out vec4 radiance;  // premultiplied by opacity

#ifdef AREA
const int kSources = 2;
#else
const int kSources = 1;
#endif
#ifdef CLEARCOAT
const int kIrradianceLobe = 2 * kSources;  // of relit, with PAPER
#else
const int kIrradianceLobe = kSources;
#endif
// Sources that are ratios of sums.
#ifdef PAPER
const int kFirstSource = 1;
#else
const int kFirstSource = 0;
#endif

// Bilinear inside the chart.
vec3 irradianceAt(int source, vec2 center, uint chart) {
    vec2 corner = floor(center - 0.5);
    vec2 t = center - 0.5 - corner;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 side = ivec2(i & 1, i >> 1);
        ivec2 texel = ivec2(corner) + side;
        if (chartAt(texel) != chart) continue;
        float weight = (side.x == 1 ? t.x : 1.0 - t.x) * (side.y == 1 ? t.y : 1.0 - t.y);
        sum += weight * vec4(texelFetch(irradiance, ivec3(texel, source), 0).rgb, 1.0);
    }
    return sum.a > 0.0 ? sum.rgb / sum.a : vec3(0.0);
}

#ifdef LOOKUP
// Of a lobe without colour, as lookup.frag draws it.
float scalarAlbedo(vec3 albedo) {
    return maxComponent(albedo);
}

// What a lobe sees: a mean of real radiances, weighted by the lobe. Where no PHATexel under the lobe is anywhere
// near, the mean over the hemisphere, an approximation. `incident`: the source's irradiance; `albedo`: the lobe's,
// without colour.
vec3 lobeRadiance(int lobeIndex, vec2 center, uint chart, vec3 incident, float albedo) {
    uvec4 bits = READ(texelFetch(seen, ivec3(gl_FragCoord.xy, lobeIndex), 0));
    vec4 sum = unpackSum(bits.xy);
    vec3 light = sum.a > 0.0 ? unpackRgb9e5(bits.x) : incident / kPi;
    // What lamps reflect, over what their irradiance is by the same PHATexels: that of the irradiance map has no noise.
    if (lobeIndex % kSources == 1)
        light += luminance(incident) / max(albedo, 1e-6) * unpackRgb9e5(bits.z);
    return light;
}

// What rays saw takes the place of the lookup's answer, the more the smoother the lobe.
vec3 tracedOver(vec3 light, int lobeIndex) {
    if (tracedLayer == 0) return light;
    int layer = tracedLayer + 2 * (lobeIndex / kSources) + lobeIndex % kSources;
    vec4 traced = uintBitsToFloat(texelFetch(seen, ivec3(gl_FragCoord.xy, layer), 0));
    return mix(light, traced.rgb, traced.a);
}

vec3 brightestHere(vec2 center) {
    return READ(texelFetch(tileLight, ivec2(floor(center)) >> 3, 0).rgb);
}
#else
// As texel_material.frag takes a colour's mean.
float scalarAlbedo(vec3 albedo) {
    return dot(albedo, vec3(1.0 / 3.0));
}

vec3 lobeRadiance(int lobeIndex, vec2 center, uint chart, vec3 incident, float albedo) {
    vec4 sum = lobeSum(relit, radii, lobeIndex, center, chart);
    return sum.a > 0.0 ? sum.rgb / sum.a : incident / kPi;
}

vec3 tracedOver(vec3 light, int lobeIndex) {
    return light;
}

vec3 brightestHere(vec2 center) {
    return brightestAround(radii, kSources - 1, center);  // the same of all lobes that are drawn
}
#endif

// The sources' estimates are independent: together they may exceed the brightest light there is, by noise alone.
void boundByBrightest(inout vec3 light[kSources], vec3 brightest) {
    vec3 sum = vec3(0.0);
    for (int source = kFirstSource; source < kSources; ++source) sum += light[source];
    vec3 scale = min(vec3(1.0), brightest / max(sum, vec3(1e-20)));
    for (int source = kFirstSource; source < kSources; ++source) light[source] *= scale;
}

void findIncident(vec2 center, uint chart, vec3 brightest, out vec3 incident[kSources]) {
    for (int source = kFirstSource; source < kSources; ++source) incident[source] = irradianceAt(source, center, chart);
    boundByBrightest(incident, kPi * brightest);
#ifdef PAPER
    incident[0] = paperMean(relit, kIrradianceLobe, center, chart);
#endif
}

// What the lobe sees of each source; `albedo`: its own, without colour.
void findSeen(int firstLobe, vec2 center, uint chart, vec3 brightest, vec3 incident[kSources], float albedo,
              out vec3 light[kSources]) {
    for (int source = kFirstSource; source < kSources; ++source)
        light[source] = lobeRadiance(firstLobe + source, center, chart, incident[source], albedo);
    boundByBrightest(light, brightest);
    for (int source = kFirstSource; source < kSources; ++source)
        light[source] = tracedOver(light[source], firstLobe + source);
#ifdef PAPER
    // What is reflected; the albedo's colour is to multiply it.
    light[0] = paperMean(relit, firstLobe, center, chart) / max(albedo, 1e-6);
#endif
}

void addGlossy(vec3 albedo, vec3 light[kSources], inout vec3 direct, inout vec3 glossyIndirect) {
    glossyIndirect += albedo * light[0];
#ifdef AREA
    direct += albedo * light[1];
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
    Brdf brdf = s.brdf;
    vec3 towardEyeLocal = s.towardEyeLocal;
    vec3 direct = emission;
    for (int light = 0; light < lightCount; ++light) {
        PunctualSample from = samplePunctual(light, vPosition);
        if (dot(from.towardLight, s.normalGeometric) <= 0.0) continue;
        vec3 reflected = evaluateBrdf(brdf, towardEyeLocal, from.towardLight * s.worldFromLocal) * from.irradiance;
        if (maxComponent(reflected) > 0.0)
            direct += reflected * shadowVisibility(light, vPosition, s.normalGeometric);
    }

    vec3 glossyIndirect = vec3(0.0), diffuseIndirect = vec3(0.0);
    uint chart = s.chart;
    if (chart != kNoChart) {
        vec2 center = s.texel;
        float nDotV = towardEyeLocal.z;
        float transmission = clearcoatTransmission(brdf, towardEyeLocal);
        vec3 diffuse = transmission * diffuseWeight(brdf, nDotV) * brdf.diffuseColor / kPi;
        vec3 specular = specularAlbedo(brdf.f0, brdf.f90, brdf.alpha, nDotV);
        vec3 brightest = brightestHere(center);
        vec3 incident[kSources], light[kSources];
        findIncident(center, chart, brightest, incident);
        if (maxComponent(specular) > 0.0) {
            findSeen(0, center, chart, brightest, incident, scalarAlbedo(specular), light);
            addGlossy(transmission * specular, light, direct, glossyIndirect);
        }
#ifdef CLEARCOAT
        if (brdf.clearcoat > 0.0) {
            findSeen(kSources, center, chart, brightest, incident, (1.0 - transmission) / brdf.clearcoat, light);
            addGlossy(vec3(1.0 - transmission), light, direct, glossyIndirect);
        }
#endif
        diffuseIndirect = diffuse * incident[0];
#ifdef AREA
        direct += diffuse * incident[1];
#endif
    }

    vec3 sum = direct * show.x + glossyIndirect * show.y + diffuseIndirect * show.z;
    // A broken vertex or texel must not spread over the picture.
    if (any(isnan(sum)) || any(isinf(sum))) sum = vec3(0.0);
    radiance = vec4(sum * alpha, alpha);
#if defined(COUNT_READS) && defined(LOOKUP)
    radiance = vec4(0.0, 0.0, 0.0, 1.0);
    for (int i = 0; i < kSources; ++i)
        radiance[i] = float(texelFetch(seen, ivec3(gl_FragCoord.xy, i), 0).y) + float(readCount[i]);
#endif
}
