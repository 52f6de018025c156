// Pass 3: a pixel. Direct light by the lamps' shadow maps, diffuse light from the irradiance maps, glossy light
// as the lobe's directional albedo times the ratio of the cone-weighted sums of the relit PHATexels.
// source: Hensley et al. 2003, sections 6.1 and 6.2; the ratio is ours (docs/pipeline.md).
#include "lib/slots.glsl"
#include "lib/cone.glsl"
#include "lib/frame.glsl"
#include "lib/lights.glsl"

in vec3 vPosition;
in vec3 vNormal;
in vec4 vTangent;
in vec4 vTexel;
flat in uvec2 vCharts;

uniform sampler2D metallicRoughnessTexture;
uniform sampler2D normalTexture;
uniform sampler2D emissionTexture;
uniform sampler2D specularTexture;
uniform sampler2D specularColorTexture;
uniform sampler2D clearcoatTexture;
uniform sampler2D clearcoatRoughnessTexture;
uniform sampler2D clearcoatNormalTexture;

uniform sampler2DArray relit;       // lobes: of the indirect light, of area lights, then their coats'
uniform sampler2DArray radii;       // the same lobes, a texel a tile
uniform sampler2DArray irradiance;  // 0 indirect, 1 area lights
uniform vec3 eyeWorld;
uniform float eyeAtInfinity;
uniform vec3 show;                  // direct, glossy indirect, diffuse indirect: 0 or 1
uniform int alphaMode;
uniform int doubleSided;

layout(location = 0) out vec4 radiance;  // premultiplied by opacity

#ifdef AREA
const int kSources = 2;
#else
const int kSources = 1;
#endif

vec3 mappedNormal(sampler2D map, int slot, float scale, vec3 normal) {
    if (!slotBound(slot) || dot(vTangent.xyz, vTangent.xyz) < 1e-8) return normal;
    vec3 n = texture(map, slotUv(slot)).xyz * 2.0 - 1.0;
    vec3 bitangent = vTangent.w * cross(normal, vTangent.xyz);
    vec3 mapped = n.x * scale * vTangent.xyz + n.y * scale * bitangent + n.z * normal;
    float size = length(mapped);
    return size > 1e-6 ? mapped / size : normal;
}

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

// What a lobe sees: a mean of real radiances, weighted by the lobe.
vec3 lobeRadiance(int lobeIndex, vec2 center, uint chart, vec3 fallback) {
    float radius = coneRadius(radii, lobeIndex, center, chart);
    vec4 sum = coneSum(relit, lobeIndex, center, max(radius, kMinRadius), chart);
    if (!(sum.a > 0.0)) sum = coneSum(relit, lobeIndex, center, kMaxRadius, chart);
    // No PHATexel under the lobe anywhere near: the mean over the hemisphere, an approximation.
    return sum.a > 0.0 ? sum.rgb / sum.a : fallback;
}

// The sources' estimates are independent: together they may exceed the brightest light there is, by noise alone.
void boundByBrightest(inout vec3 light[kSources], vec3 brightest) {
    vec3 sum = vec3(0.0);
    for (int source = 0; source < kSources; ++source) sum += light[source];
    vec3 scale = min(vec3(1.0), brightest / max(sum, vec3(1e-20)));
    for (int source = 0; source < kSources; ++source) light[source] *= scale;
}

void addGlossy(vec3 albedo, vec3 seen[kSources], inout vec3 direct, inout vec3 glossyIndirect) {
    glossyIndirect += albedo * seen[0];
#ifdef AREA
    direct += albedo * seen[1];
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

    float side = gl_FrontFacing ? 1.0 : -1.0;
    vec3 emission = factors.emission * texture(emissionTexture, slotUv(kSlotEmission)).rgb;
    if (factors.unlit) {
        radiance = vec4(emission * vColor.rgb * show.x * alpha, alpha);
        return;
    }

    vec3 towardEye = normalize(eyeWorld - vPosition * (1.0 - eyeAtInfinity));
    vec3 vertexNormal = normalize(vNormal);
    vec3 normal = side * mappedNormal(normalTexture, kSlotNormal, factors.normalScale, vertexNormal);
    // Interpolated normals may face away from the eye at silhouettes; bend them back just over the edge.
    const float kLeastCosine = 1e-3;
    float cosine = dot(normal, towardEye);
    if (cosine < kLeastCosine) normal = normalize(normal + (kLeastCosine - cosine) * towardEye);

    vec4 metallicRoughness = texture(metallicRoughnessTexture, slotUv(kSlotMetallicRoughness));
    MaterialTexels texels = MaterialTexels(
        vColor.rgb * texture(baseColorTexture, slotUv(kSlotBaseColor)).rgb, metallicRoughness.g,
        metallicRoughness.b, texture(specularTexture, slotUv(kSlotSpecular)).a,
        texture(specularColorTexture, slotUv(kSlotSpecularColor)).rgb,
        texture(clearcoatTexture, slotUv(kSlotClearcoat)).r,
        texture(clearcoatRoughnessTexture, slotUv(kSlotClearcoatRoughness)).g);
    mat3 worldFromLocal = frameFromNormal(normal);
    vec3 coatNormal =
        mappedNormal(clearcoatNormalTexture, kSlotClearcoatNormal, factors.clearcoatNormalScale, vertexNormal);
    Brdf brdf = brdfFrom(factors, texels, side * coatNormal * worldFromLocal);
    vec3 towardEyeLocal = towardEye * worldFromLocal;

    // Derivatives give the flat triangle's plane without another attribute.
    vec3 normalGeometric = normalize(cross(dFdx(vPosition), dFdy(vPosition)));
    if (dot(normalGeometric, towardEye) < 0.0) normalGeometric = -normalGeometric;

    vec3 direct = emission;
    for (int light = 0; light < lightCount; ++light) {
        PunctualSample from = samplePunctual(light, vPosition);
        if (dot(from.towardLight, normalGeometric) <= 0.0) continue;
        vec3 reflected = evaluateBrdf(brdf, towardEyeLocal, from.towardLight * worldFromLocal) * from.irradiance;
        if (maxComponent(reflected) > 0.0)
            direct += reflected * shadowVisibility(light, vPosition, normalGeometric);
    }

    vec3 glossyIndirect = vec3(0.0), diffuseIndirect = vec3(0.0);
    uint chart = gl_FrontFacing ? vCharts.x : vCharts.y;
    if (chart != kNoChart) {
        vec2 center = gl_FrontFacing ? vTexel.xy : vTexel.zw;
        float nDotV = towardEyeLocal.z;
        float transmission = clearcoatTransmission(brdf, towardEyeLocal);
        vec3 diffuse = transmission * diffuseWeight(brdf, nDotV) * brdf.diffuseColor / kPi;
        vec3 specular = transmission * specularAlbedo(brdf.f0, brdf.f90, brdf.alpha, nDotV);
        vec3 brightest = brightestAround(radii, center);
        vec3 incident[kSources], seen[kSources];
        for (int source = 0; source < kSources; ++source)
            incident[source] = irradianceAt(source, center, chart);
        boundByBrightest(incident, kPi * brightest);
        if (maxComponent(specular) > 0.0) {
            for (int source = 0; source < kSources; ++source)
                seen[source] = lobeRadiance(source, center, chart, incident[source] / kPi);
            boundByBrightest(seen, brightest);
            addGlossy(specular, seen, direct, glossyIndirect);
        }
#ifdef CLEARCOAT
        if (brdf.clearcoat > 0.0) {
            for (int source = 0; source < kSources; ++source)
                seen[source] = lobeRadiance(source + kSources, center, chart, incident[source] / kPi);
            boundByBrightest(seen, brightest);
            addGlossy(vec3(1.0 - transmission), seen, direct, glossyIndirect);
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
}
