// Adds one jittered picture to the pixels' box filter (additive blending).

uniform sampler2D picture;
uniform float weight;

layout(location = 0) out vec4 radiance;

void main() {
    radiance = weight * texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
}
