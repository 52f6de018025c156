// A picture of what compiles at once, for as long as the programs of the whole one are being compiled: base colours by
// the baked irradiance and by punctual lights, as if everything were diffuse. Where those are left out, so is emission:
// somebody else adds both.
#include "lib/contact_shadow.glsl"
#include "lib/irradiance.glsl"
#include "lib/slots.glsl"
#include "lib/visible_point.glsl"
#ifndef WITHOUT_PUNCTUAL_LIGHTS
#include "lib/lights.glsl"
uniform sampler2D emissionTexture;
#endif

in vec3 vNormal;

uniform vec3 show;  // see display.frag
uniform int alphaMode;

layout(location = 0) out vec4 radiance;

vec3 shadingNormal(VisiblePoint point) {
    return faceforward(normalize(vNormal), -point.normalGeometric, vNormal);
}

#ifndef WITHOUT_PUNCTUAL_LIGHTS
vec3 emissionOf(MaterialFactors factors) {
    vec3 emission = factors.emission * texture(emissionTexture, slotUv(kSlotEmission)).rgb;
    return factors.unlit ? emission * vColor.rgb : emission;
}

// On the surface, W/m2.
vec3 punctualIrradiance(VisiblePoint point) {
    vec3 sum = vec3(0.0);
    vec3 normal = shadingNormal(point);
    for (int light = 0; light < lightCount; ++light) {
        PunctualSample from = samplePunctual(light, vPosition);
        float cosine = dot(from.towardLight, normal);
        if (cosine <= 0.0 || dot(from.towardLight, point.normalGeometric) <= 0.0) continue;
        sum += cosine * from.irradiance * shadowVisibility(light, vPosition, point.normalGeometric);
    }
    return sum;
}
#endif

void main() {
    VisiblePoint point = visiblePoint();
    if (alphaMode == 1 && opacity() < material[3].a) discard;
    vec4 rows[kFactorRows];
    for (int i = 0; i < kFactorRows; ++i) rows[i] = material[i];
    MaterialFactors factors = unpackFactors(rows);
    vec3 direct = vec3(0.0), indirect = vec3(0.0);
#ifndef WITHOUT_PUNCTUAL_LIGHTS
    direct = emissionOf(factors);
#endif
    if (!factors.unlit) {
        vec3 color = factors.baseColor.rgb * vColor.rgb * texture(baseColorTexture, slotUv(kSlotBaseColor)).rgb;
        vec3 baked[kSources];
        for (int source = 0; source < kSources; ++source) baked[source] = vec3(0.0);
        if (point.chart != kNoChart) irradianceAt(point.texel, point.chart, baked);
#ifndef WITHOUT_PUNCTUAL_LIGHTS
        direct += color / kPi * punctualIrradiance(point);
#endif
        vec3 diffuse = color / kPi * unoccludedByThings(vPosition, shadingNormal(point));
        indirect = diffuse * baked[0];
#ifdef AREA
        direct += diffuse * baked[1];
#endif
    }
    vec3 sum = direct * show.x + indirect * show.z;
    // A broken vertex or texel must not spread over the picture.
    if (any(isnan(sum)) || any(isinf(sum))) sum = vec3(0.0);
    radiance = vec4(sum, 1.0);
}
