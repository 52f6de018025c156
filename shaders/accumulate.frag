// Adds one jittered image to the sum of the box filter (additive blending).

uniform sampler2D picture;

layout(location = 0) out vec4 radiance;

void main() {
    radiance = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
}
