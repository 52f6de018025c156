// What glass lets through of a punctual light's rays, to be multiplied, and its depth, of which the least counts.
#include "lib/slots.glsl"

in vec3 vPosition;
in vec3 vNormal;

uniform int alphaMode;
uniform vec3 lightWorld;  // position, or the direction toward it
uniform float lightAtInfinity;
// Without the textures of the material but its base colour's.
#define SLOTS_ALONE
#include "lib/glass.glsl"

layout(location = 0) out vec4 tint;

void main() {
    float alpha = alphaMode == 0 ? 1.0 : opacity();
    if (alphaMode == 1 && alpha < material[3].a) discard;
    if (alphaMode == 1) alpha = 1.0;
    vec4 rows[kFactorRows];
    for (int i = 0; i < kFactorRows; ++i) rows[i] = material[i];
    MaterialFactors factors = unpackFactors(rows);
    vec3 base = vColor.rgb * texture(baseColorTexture, slotUv(kSlotBaseColor)).rgb;
    Brdf brdf = brdfFrom(factors, MaterialTexels(base, 1.0, 1.0, 1.0, vec3(1.0), 1.0, 1.0, 1.0), vec3(0.0, 0.0, 1.0));
    vec3 towardLight = normalize(lightWorld - vPosition * (1.0 - lightAtInfinity));
    float cosine = max(abs(dot(normalize(vNormal), towardLight)), 1e-3);
    vec3 through = (1.0 - maxComponent(schlick(brdf.f0, brdf.f90, cosine))) * brdf.transmissionColor;
    // Each of a volume's two sides brings its half of the attenuation.
    vec3 left = glassAttenuation(factors, cosine);
    through *= glassInterfaces == kGlassVolume ? sqrt(left) : left;
    tint = vec4(mix(vec3(1.0), through, alpha), gl_FragCoord.z);
}
