// A surface that was not in the bake: emission, punctual lights by their shadow maps, diffuse light of the probes.
// Glossy light is the probes' irradiance of a surface that faces where a mirror shows, over pi: blurred over a
// hemisphere, an approximation for all but rough surfaces.
#include "lib/probe_light.glsl"
#include "lib/reflected_lights.glsl"

uniform vec3 show;  // see display.frag
uniform int alphaMode;

layout(location = 0) out vec4 radiance;  // premultiplied by opacity

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
    ViewedBrdf viewed = viewedBrdf(s.brdf, s.towardEyeLocal);
    vec3 direct = emission;
    addPunctualLights(s, viewed, direct);
    vec3 normal = s.worldFromLocal[2];
    vec3 normals[2] = vec3[2](normal, reflect(-s.towardEye, normal));
    ProbeIrradiance light = probeIrradiance(vPosition, normals);
    vec3 glossy = (viewed.transmission * viewed.specularAlbedo + 1.0 - viewed.transmission) / kPi;
    direct += viewed.diffuse * light.area[0] + glossy * light.area[1];
    vec3 sum = direct * show.x + glossy * light.indirect[1] * show.y + viewed.diffuse * light.indirect[0] * show.z;
    // A broken vertex must not spread over the picture.
    if (any(isnan(sum)) || any(isinf(sum))) sum = vec3(0.0);
    radiance = vec4(sum * alpha, alpha);
}
