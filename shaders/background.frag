// The environment behind everything.
// twin: LightSampler::environmentRadiance in src/core/scene/lights.h.
#include "lib/environment.glsl"

uniform mat4 worldFromClip;      // of the camera's rotation alone, depth from -1 to 1
uniform vec2 viewport;

layout(location = 0) out vec4 radiance;

void main() {
    vec2 ndc = gl_FragCoord.xy / viewport * 2.0 - 1.0;
    vec4 far = worldFromClip * vec4(ndc, 1.0, 1.0);
    vec4 near = worldFromClip * vec4(ndc, -1.0, 1.0);
    radiance = vec4(environmentRadiance(normalize(far.xyz / far.w - near.xyz / near.w)), 1.0);
}
