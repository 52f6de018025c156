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
    vec3 toward = pointOnEmitter(emitter, stratifiedSquare(t.inBlock, t.scramble, u.xy)) - point.position;
    float square = dot(toward, toward);
    if (!(square > 0.0)) return;
    float meters = sqrt(square);
    vec3 direction = toward / meters;
    float cosine = dot(direction, point.normal);
    if (cosine <= 0.0 || dot(direction, point.flatNormal) <= 0.0) return;
    float emitted = -dot(normalize(cross(emitter.b - emitter.a, emitter.c - emitter.a)), direction);
    if (emitter.doubleSided) emitted = abs(emitted);
    if (emitted < 1e-6) return;
    float lightPdf = emitter.areaDensity * square / emitted;
    float ratio = cosine / kPi / lightPdf, weight = 1.0 / (1.0 + ratio * ratio);
    if (anyHit(offsetOrigin(point.position, point.flatNormal, vec3(0.0)), direction, meters * (1.0 - 1e-4))) return;
    areaOut = vec4(emitter.radiance * (cosine * weight / (kPi * lightPdf)), 0.0);
}
