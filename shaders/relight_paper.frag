// Pass 1 as the paper has it, once a frame: each PHATexel is a sample of one uniform density,
//   E = 2 pi L cos (footnote 1),   f(toward the eye, toward the light) E,
// whatever density its direction was drawn with. The normaliser is the filter's weight, the number of PHATexels.
// Colour is left to the third pass, as the paper leaves it texturing.
// source: Hensley et al. 2003, section 6.
#include "lib/atlas.glsl"
#include "lib/phatexel.glsl"
#include "lib/scalar_lobe.glsl"
#include "lib/tile_patch.glsl"

uniform usampler2DArray phatexels;     // [layer][y][x] packed, 8 bytes
uniform usampler2D tilePatches;        // see lib/tile_patch.glsl
uniform sampler2D texelNormals;        // octahedral: xy shading normal, zw coat normal; world
uniform sampler2D texelBrdf;           // see texel_material.frag
uniform vec3 eyeWorld;                 // or, for a parallel projection, the direction toward the eye
uniform float eyeAtInfinity;           // 1: parallel projection
uniform int firstLayer;
uniform int layerCount;

layout(location = 0) out vec4 specular;    // sum of f E, PHATexels
layout(location = 1) out vec4 irradiance;  // sum of E, PHATexels: what a Lambert surface needs
#ifdef CLEARCOAT
layout(location = 2) out vec4 coat;        // as specular
#endif

vec3 irradianceOf(Phatexel phatexel, vec3 normal, vec3 towardLight) {
    return 2.0 * kPi * max(dot(normal, towardLight), 0.0) * phatexel.radiance;
}

vec4 reflectedBy(ScalarLobe lobe, vec3 towardEye, vec3 towardLight, Phatexel phatexel) {
    vec3 irradiance = irradianceOf(phatexel, lobe.normalWorld, towardLight);
    return vec4(lobeBrdfWorld(lobe, towardEye, towardLight) * irradiance, 1.0);
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    specular = vec4(0.0);
    irradiance = vec4(0.0);
#ifdef CLEARCOAT
    coat = vec4(0.0);
#endif
    if (chartAt(texel) == kNoChart) return;

    vec4 brdf = texelFetch(texelBrdf, texel, 0);
    vec4 normals = texelFetch(texelNormals, texel, 0);
    ivec2 tile = texel >> 3;
    TilePatch tilePatch = tilePatchAt(tilePatches, tile, texelSizeOfTile(tile));
    vec3 position = positionOnPatch(tilePatch, vec2(texel & 7) - 3.5);
    mat3 worldFromBlock = tilePatch.worldFromBlock;
    vec3 towardEye = normalize(eyeWorld - position * (1.0 - eyeAtInfinity));

    ScalarLobe base = ScalarLobe(octahedralToDirection(normals.xy), brdf.x, brdf.y, brdf.z);
    for (int layer = 0; layer < layerCount; ++layer) {
        Phatexel phatexel = unpackPhatexel(texelFetch(phatexels, ivec3(texel, firstLayer + layer), 0).xy);
        if (!phatexel.valid) continue;
        vec3 towardLight = worldFromBlock * phatexel.directionBlock;
        specular += reflectedBy(base, towardEye, towardLight, phatexel);
        irradiance += vec4(irradianceOf(phatexel, base.normalWorld, towardLight), 1.0);
#ifdef CLEARCOAT
        if (brdf.w > 0.0) {
            ScalarLobe coatLobe = ScalarLobe(octahedralToDirection(normals.zw), kClearcoatF0, 1.0, brdf.w);
            coat += reflectedBy(coatLobe, towardEye, towardLight, phatexel);
        }
#endif
    }
}
