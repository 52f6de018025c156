// The material at each texel of the atlas as relighting reads it. Drawn when materials change.
#include "lib/material.glsl"
#include "lib/table.glsl"

uniform usampler2D texelMaterial;   // material number
uniform sampler2D texelTexturesA;   // mean base colour, roughness, metallic, specular
uniform sampler2D texelTexturesB;   // mean specular colour, clearcoat, clearcoat roughness
uniform sampler2D materialTable;    // kFactorRows texels a material

layout(location = 0) out vec4 base;  // mean F0, F90, alpha, clearcoat alpha (0: no coat)

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    int material = int(texelFetch(texelMaterial, texel, 0).r);
    vec4 rows[kFactorRows];
    for (int i = 0; i < kFactorRows; ++i)
        rows[i] = texelFetch(materialTable, tableTexel(material * kFactorRows + i), 0);
    vec4 a = texelFetch(texelTexturesA, texel, 0);
    vec4 b = texelFetch(texelTexturesB, texel, 0);
    MaterialTexels texels = MaterialTexels(a.rrr, a.g, a.b, a.a, b.rrr, b.g, b.b, 1.0);
    Brdf brdf = brdfFrom(unpackFactors(rows), texels, vec3(0.0, 0.0, 1.0));
    base = vec4(dot(brdf.f0, vec3(1.0 / 3.0)), brdf.f90, brdf.alpha,
                brdf.clearcoat > 0.0 ? brdf.clearcoatAlpha : 0.0);
}
