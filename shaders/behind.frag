// What rough glass is in front of: the picture so far, and how near to the eye its surfaces are. Its smaller levels are
// what lib/behind.glsl reads.
#include "lib/nearness.glsl"

uniform sampler2D picture;
uniform sampler2D depth;
uniform mat4 worldFromClip;
uniform vec2 viewport;
uniform vec3 eyeWorld;
uniform float eyeAtInfinity;

layout(location = 0) out vec4 behind;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float z = texelFetch(depth, pixel, 0).r;
    vec4 position = worldFromClip * vec4(2.0 * gl_FragCoord.xy / viewport - 1.0, z, 1.0);
    float near = nearness(position.xyz / position.w, eyeWorld, eyeAtInfinity);
    if (z <= 0.0 && eyeAtInfinity < 0.5) near = 0.0;  // the sky
    behind = vec4(texelFetch(picture, pixel, 0).rgb, near);
}
