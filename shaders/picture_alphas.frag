// Alpha of a picture's texels, row by row, into their part of the table that lib/bvh_opacity.glsl reads.
#include "lib/table.glsl"

uniform sampler2D picture;
uniform int firstTexel;

layout(location = 0) out vec4 alpha;

void main() {
    ivec2 size = textureSize(picture, 0), at = ivec2(gl_FragCoord.xy);
    int texel = at.y * kTableWidth + at.x - firstTexel;
    if (texel < 0 || texel >= size.x * size.y) discard;
    alpha = vec4(texelFetch(picture, ivec2(texel % size.x, texel / size.x), 0).a);
}
