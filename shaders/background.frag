// The environment behind everything.
// twin: LightSampler::environmentRadiance in src/core/scene/lights.h.
#include "lib/hemisphere_map.glsl"

uniform sampler2D environment;   // column 0 at azimuth atan(z, x) = -pi, row 0 at +Y
uniform mat4 worldFromClip;      // of the camera's rotation alone, depth from -1 to 1
uniform vec2 viewport;
uniform float turn;              // of the environment, in turns; see turned in src/core/scene/environment_sampling.h

layout(location = 0) out vec4 radiance;

void main() {
    vec2 ndc = gl_FragCoord.xy / viewport * 2.0 - 1.0;
    vec4 far = worldFromClip * vec4(ndc, 1.0, 1.0);
    vec4 near = worldFromClip * vec4(ndc, -1.0, 1.0);
    vec3 d = normalize(far.xyz / far.w - near.xyz / near.w);
    vec2 uv = vec2(atan(d.z, d.x) / (2.0 * kPi) + 0.5 - turn, acos(clamp(d.y, -1.0, 1.0)) / kPi);
    radiance = vec4(textureLod(environment, uv, 0.0).rgb, 1.0);
}
