// Depth alone: before the display pass, so that it shades each pixel once, and for the shadow maps.
#include "lib/slots.glsl"

uniform int alphaMode;  // 0 opaque, 1 mask, 2 blend (shadow maps only)

// Opacity as coverage: light passes a blended surface in proportion. The 4x4 threshold matrix (Bayer 1973)
// matches the 4x4 taps of the shadow lookup, whose average then is the opacity to within 1/16.
bool ditheredAway(float alpha) {
    ivec2 p = ivec2(gl_FragCoord.xy);
    int x = p.x & 3, y = p.y & 3;
    int fine = ((x ^ y) & 1) * 2 + (y & 1);
    int coarse = (((x ^ y) >> 1) & 1) * 2 + ((y >> 1) & 1);
    return alpha <= (float(fine * 4 + coarse) + 0.5) / 16.0;
}

void main() {
    if (alphaMode == 0) return;
    float alpha = opacity();
    if (alphaMode == 1 ? alpha < material[3].a : ditheredAway(alpha)) discard;
}
