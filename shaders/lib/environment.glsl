// The environment, and how dense light samples of it are.
// twin: environmentRadiance in src/core/scene/environment_sampling.h; src/gl/environment_upload.cpp writes the picture.
#include "lib/hemisphere_map.glsl"

uniform sampler2D environment;  // column 0 at azimuth atan(z, x) = -pi, row 0 at +Y; a: see environmentPdf
uniform float turn;             // of the environment, in turns; see turned in src/core/scene/environment_sampling.h

vec2 environmentUv(vec3 d) {
    return vec2(atan(d.z, d.x) / (2.0 * kPi) + 0.5 - turn, acos(clamp(d.y, -1.0, 1.0)) / kPi);
}

vec3 environmentRadiance(vec3 d) {
    return textureLod(environment, environmentUv(d), 0.0).rgb;
}

// Density with which sampleEnvironment in lib/environment_samples.glsl finds what a texel shows, 1/sr. The texel holds its
// root, so that half floats suffice.
float environmentPdfAt(ivec2 texel) {
    float root = texelFetch(environment, texel, 0).a;
    return root * root;
}

float environmentPdf(vec3 d) {
    vec2 uv = environmentUv(d), size = vec2(textureSize(environment, 0));
    return environmentPdfAt(ivec2(min(vec2(fract(uv.x), uv.y) * size, size - 1.0)));
}
