// splitSumTable, a texel an entry, for renderers that have no CPU to spare.
// twin: integrateSplitSumTable in src/core/scene/brdf.cpp.
#include "lib/split_sum.glsl"

uniform int size;

layout(location = 0) out vec4 entry;

void main() {
    const float kMinCosine = 1e-3;  // at 0 the visible normals are undefined
    vec2 at = floor(gl_FragCoord.xy) / float(size - 1);
    entry = vec4(integrateSplitSum(max(at.x, kMinCosine), max(at.y * at.y, kMinAlpha)), 0.0, 0.0);
}
