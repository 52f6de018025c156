// How much the radiance of the PHATexels of some blocks' tiles is another one than before: sums over their densities.
#include "lib/brdf.glsl"
#include "lib/phatexel.glsl"
#include "lib/texel_batch.glsl"

uniform usampler2DArray phatexels;  // before
uniform usampler2D newPhatexels;    // of the batch, see pack_phatexels.frag
uniform sampler2D guidePdf;         // see lib/phatexel.glsl
uniform int guideCount;
uniform int layer;                  // of the PHATexels

layout(location = 0) out vec2 sumsOut;  // of the changes; of the greater of the two

const int kTileBits = 3;

void main() {
    ivec2 first = ivec2(gl_FragCoord.xy) << kTileBits;
    sumsOut = vec2(0.0);
    for (int i = 0; i < 1 << (2 * kTileBits); ++i) {
        ivec2 pixel = first + ivec2(i & ((1 << kTileBits) - 1), i >> kTileBits);
        BatchTexel t = batchTexelAt(pixel);
        if (!t.valid) continue;
        Phatexel now = unpackPhatexel(texelFetch(newPhatexels, pixel, 0).xy);
        Phatexel before = unpackPhatexel(texelFetch(phatexels, ivec3(t.texel, layer), 0).xy);
        if (!now.valid || !before.valid) continue;
        float pdf = squareToGuidePdf(guidePdf, guideCount == 1 ? 0 : t.block.block, now.directionBlock);
        vec3 change = abs(now.radiance - before.radiance);
        sumsOut += vec2(luminance(change), luminance(max(now.radiance, before.radiance))) / pdf;
    }
}
