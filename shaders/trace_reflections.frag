// Reflection ray number `ray` of each pixel's lobe, and what it hits.
#include "lib/bvh.glsl"
#include "lib/lobe_pixels.glsl"
#include "lib/packed_rays.glsl"
#include "lib/ray_origin.glsl"
#include "lib/mirror_lobe.glsl"
#include "lib/sample_numbers.glsl"
#include "lib/scalar_lobe.glsl"
#include "lib/visible_normal.glsl"
#ifdef GLASS
#include "lib/glass_rays.glsl"
#endif

uniform usampler2D points;  // see lobes.frag
uniform usampler2D guides;
uniform vec3 eyeWorld;
uniform float eyeAtInfinity;
uniform int lobe;
uniform int ray;

layout(location = 0) out uvec4 hitOut;  // see lib/packed_rays.glsl
layout(location = 1) out uvec4 placeOut;

const float kFar = 1e30;

// Pixels that trace no ray are discarded; the target is cleared.
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    int rays = int(texelFetch(guides, pixel, 0).z >> 24);
    if (ray >= rays) discard;
    PixelLobe l = pixelLobe(pixel, lobe);
    uvec4 point = texelFetch(points, pixel, 0);
    vec3 position = uintBitsToFloat(point.xyz);
    vec3 normalGeometric = octahedralToDirection(unpackSnorm2x16(point.w));
    mat3 worldFromLocal = frameFromNormal(l.normal);
    vec3 towardEye = normalize(eyeWorld - position * (1.0 - eyeAtInfinity)), wo = towardEye * worldFromLocal;
    if (wo.z <= 0.0) discard;
    bool isMirror = l.alpha < kMinPooledAlpha;
    vec2 u = sampleNumbersOf(ray, pixel, rays).xy;
    if (isMirror) u.x *= kMirrorPart;
    vec3 h = squareToVisibleNormal(u, wo, l.alpha);
    vec3 wi = reflect(-wo, h);
    vec3 direction = normalize(worldFromLocal * wi);
    float above = dot(direction, normalGeometric);
    if (wi.z <= 0.0) discard;
    if (above <= 0.0) {
        // At the silhouettes of coarse meshes. A mirror's pixel has no other ray, and would be black.
        if (!isMirror) discard;
        direction = normalize(direction + (1e-3 - above) * normalGeometric);
    }
    float weight = schlick(vec3(l.f0), l.f90, dot(wo, h)).x * visibleNormalWeight(wi, wo, l.alpha);
    // Of a mirror that of its peak, as if all its rays were there.
    float pdf = smithG1(wo.z, l.alpha) * ggxD(isMirror ? 1.0 : h.z, l.alpha) / (4.0 * wo.z);

    vec3 origin = offsetOrigin(position, normalGeometric, towardEye);
    vec3 tint = vec3(1.0);
    float way = 0.0;
#ifdef GLASS
    GlassWalk walk = GlassWalk(origin, direction, tint, vec3(0.0), way);
    BvhHit hit = seeThrough(walk, kFar);
    origin = walk.origin;
    direction = walk.direction;
    tint = walk.tint;
    way = walk.meters;
#else
    BvhHit hit = closestHit(origin, direction, kFar);
#endif
    packRay(TracedRay(rays, direction, tint, weight, pdf, hit.triangle, hit.backFace, hit.barycentric,
                      way + hit.distance, origin + direction * hit.distance), hitOut, placeOut);
}
