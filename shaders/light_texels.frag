// Light that each texel of some blocks receives from one sampled point of the emitters, over pi.
// The weights are those of emissionWeight in shade_reflections.frag, against the texel's ray by the cosine.
#include "lib/bvh.glsl"
#include "lib/hit_surface.glsl"
#include "lib/random.glsl"
#include "lib/ray_origin.glsl"
#include "lib/texel_batch.glsl"
#include "lib/texel_point.glsl"

uniform int seed;

layout(location = 0) out vec4 areaOut;

void main() {
    areaOut = vec4(0.0);
    BatchTexel t = batchTexelAt(ivec2(gl_FragCoord.xy));
    if (!t.valid) return;
    TexelPoint point = texelPointAt(t.texel);
    if (!point.receives) return;
    vec3 u = randomNumbers(uvec3(t.texel, seed));
    // The layout's numbers choose the point; which emitter is left to chance.
    HitEmitter emitter = hitEmitter(chooseEmitter(u.z));
    EmitterSample light = sampleEmitter(emitter, stratifiedSquare(t.inBlock, t.block.scramble, u.xy), point.position);
    float cosine = dot(light.direction, point.normal);
    if (light.pdf <= 0.0 || cosine <= 0.0 || dot(light.direction, point.flatNormal) <= 0.0) return;
    float weight = powerWeight(light.pdf, cosine / kPi);
    vec3 origin = offsetOrigin(point.position, point.flatNormal, vec3(0.0));
    if (anyHit(origin, light.direction, light.meters * (1.0 - 1e-4))) return;
    areaOut = vec4(light.radiance * (cosine * weight / (kPi * light.pdf)), 0.0);
}
