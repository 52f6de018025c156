// PHATexels of some blocks from their rays.
#include "lib/packed_rays.glsl"
#include "lib/phatexel.glsl"

uniform usampler2D hits;     // see lib/packed_rays.glsl
uniform usampler2D codes;    // see trace_texels.frag
uniform sampler2D radiance;  // of the rays

layout(location = 0) out uvec2 phatexelOut;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint code = texelFetch(codes, pixel, 0).x;
    phatexelOut = uvec2(0u);
    if (code == 0xffffffffu) return;
    uvec4 hit = texelFetch(hits, pixel, 0);
    float meters = hitsNothing(hit) ? kFarDistance : hitDistance(hit);
    phatexelOut = uvec2(packRgb9e5(texelFetch(radiance, pixel, 0).rgb), code | (packDistance(meters) << 24));
}
