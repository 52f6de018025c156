// Adds one jittered picture to the pixels' box filter (additive blending).

uniform sampler2D picture;

layout(location = 0) out vec4 radiance;

void main() {
    radiance = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
}
