// The window's picture: means of two sums of samples side by side, tone mapped, or how far they are apart.
#include "lib/heat.glsl"
#include "lib/tone_map.glsl"

uniform sampler2D left;
uniform sampler2D right;
uniform vec2 corner;       // of the picture in the target, pixels
uniform vec2 size;
uniform float leftScale;   // 1 / samples
uniform float rightScale;
uniform float wipe;        // pixels from the left
uniform int leftToneMapping;
uniform float leftExposureStops;
uniform int rightToneMapping;
uniform float rightExposureStops;
uniform float leftHeat;    // > 0: numbers, shown as heat from 0 to 1 over this
uniform float rightHeat;
uniform int difference;    // 1: instead of the pictures

layout(location = 0) out vec4 color;

// IEC 61966-2-1.
vec3 srgbFromLinear(vec3 c) {
    return mix(1.055 * pow(max(c, vec3(1e-8)), vec3(1.0 / 2.4)) - 0.055, 12.92 * c, vec3(lessThan(c, vec3(0.0031308))));
}

void main() {
    vec2 pixel = gl_FragCoord.xy - corner;
    vec2 uv = pixel / size;
    vec3 a = texture(left, uv).rgb * leftScale, b = texture(right, uv).rgb * rightScale;
    a = leftHeat > 0.0 ? heat((a.r + a.g) * leftHeat) : toneMap(a, leftToneMapping, leftExposureStops);
    b = rightHeat > 0.0 ? heat((b.r + b.g) * rightHeat) : toneMap(b, rightToneMapping, rightExposureStops);
    if (difference == 1) {
        // Of the right picture's display value, so that black pixels do not divide.
        vec3 apart = abs(a - b) / (b + 0.05);
        color = vec4(heat(max(apart.r, max(apart.g, apart.b))), 1.0);
        return;
    }
    color = vec4(srgbFromLinear(pixel.x < wipe ? a : b), 1.0);
}
