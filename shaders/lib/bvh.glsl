// Rays through a bounding volume hierarchy of four children a node, nearest child first.
// twin: src/core/bvh/bvh_rays.cpp; the layouts are those of src/core/bvh/bvh_node.h and src/core/bvh/bvh_triangle.h.
// With BVH_OPACITY masked and blended surfaces let rays pass as RayScene's do.
#include "lib/table.glsl"

uniform usampler2D bvhNodes;      // table: three texels a node
uniform usampler2D bvhTriangles;  // table: two texels a triangle
uniform vec3 bvhGridStep;
uniform int bvhRoot;

struct BvhHit {
    float distance;
    int triangle;  // in the order of the leaves; < 0: none
    vec2 barycentric;
    bool backFace;
};

#ifdef BVH_OPACITY
#include "lib/bvh_opacity.glsl"
#endif

const int kBvhStackWords = 32;         // twin: src/core/bvh/scene_bvh.h
const int kMaxVisits = 65536;          // twin: src/core/bvh/bvh_rays.cpp
const int kMaxSteps = 16;              // for a node: four leaves of four triangles each
const uint kInstance = 255u;           // twin: src/core/bvh/bvh_node.h
const float kMinComponent = 5.421011e-20;    // 2^-64
const float kSlabRounding = 4.7683716e-7;    // 2^-21
const float kEdgeRounding = 2.3841858e-7;    // 2^-22
const float kCoincident = 3.8146973e-6;      // 2^-18
const uint kMissed = 0xffffffffu;

// A ray in the space of the tree that is being traversed.
struct LocalRay {
    vec3 origin;
    vec3 direction;
    vec3 inverse;
    bool mirrored;
};

float inverseOf(float d) {
    return 1.0 / (abs(d) >= kMinComponent ? d : d < 0.0 ? -kMinComponent : kMinComponent);
}

LocalRay localRay(vec3 origin, vec3 direction) {
    return LocalRay(origin, direction, vec3(inverseOf(direction.x), inverseOf(direction.y), inverseOf(direction.z)),
                    false);
}

uvec4 nodeTexel(uint node, int texel) {
    return texelFetch(bvhNodes, tableTexel(3 * int(node) + texel), 0);
}

// `head`: the first texel of an instance.
LocalRay instanceRay(uvec4 head, vec3 origin, vec3 direction) {
    vec4 x = uintBitsToFloat(nodeTexel(head.z, 0)), y = uintBitsToFloat(nodeTexel(head.z, 1)),
         z = uintBitsToFloat(nodeTexel(head.z, 2));
    LocalRay ray = localRay(vec3(dot(x.xyz, origin) + x.w, dot(y.xyz, origin) + y.w, dot(z.xyz, origin) + z.w),
                            vec3(dot(x.xyz, direction), dot(y.xyz, direction), dot(z.xyz, direction)));
    ray.mirrored = head.y != 0u;
    return ray;
}

vec4 bytesOf(uint word) {
    return vec4(float(word & 255u), float((word >> 8u) & 255u), float((word >> 16u) & 255u), float(word >> 24u));
}

uvec4 sorted(uvec4 keys) {
    uvec2 low = min(keys.xz, keys.yw), high = max(keys.xz, keys.yw);
    uint second = max(low.x, low.y), third = min(high.x, high.y);
    return uvec4(min(low.x, low.y), min(second, third), max(second, third), max(high.x, high.y));
}

// Where the ray enters the children's boxes, nearest first: the bits of the distance, the lowest two of which are the
// child's number. `a`, `b`, `c`: the node's texels.
uvec4 childKeys(uvec4 a, uvec4 b, uvec4 c, LocalRay ray, float maxDistance) {
    vec3 scale = uintBitsToFloat(uvec3(a.w & 255u, (a.w >> 8u) & 255u, (a.w >> 16u) & 255u) << 23u);
    vec3 toOrigin = (uintBitsToFloat(a.xyz) - ray.origin) * ray.inverse;
    vec3 margin = abs(toOrigin) * kSlabRounding, unit = scale * ray.inverse;
    vec3 near = toOrigin - margin, far = toOrigin + margin;
    bvec3 backward = lessThan(ray.inverse, vec3(0.0));
    vec4 inX = bytesOf(backward.x ? b.w : b.x) * unit.x + near.x;
    vec4 inY = bytesOf(backward.y ? c.x : b.y) * unit.y + near.y;
    vec4 inZ = bytesOf(backward.z ? c.y : b.z) * unit.z + near.z;
    vec4 outX = bytesOf(backward.x ? b.x : b.w) * unit.x + far.x;
    vec4 outY = bytesOf(backward.y ? b.y : c.x) * unit.y + far.y;
    vec4 outZ = bytesOf(backward.z ? b.z : c.y) * unit.z + far.z;
    vec4 entry = max(max(inX, inY), max(inZ, vec4(0.0)));
    vec4 exit = min(min(outX, outY), min(outZ, vec4(maxDistance)));
    bvec4 met = lessThanEqual(entry, exit * (1.0 + kSlabRounding));
    uvec4 keys = (floatBitsToUint(entry) & uvec4(~3u)) | uvec4(0u, 1u, 2u, 3u);
    return sorted(uvec4(met.x ? keys.x : kMissed, met.y ? keys.y : kMissed, met.z ? keys.z : kMissed,
                        met.w ? keys.w : kMissed));
}

// What the upper 28 bits say, in sixteenths of a step.
vec3 gridPoint(uvec3 words) {
    return vec3(ivec3(words & uvec3(~15u)));
}

// An edge that two triangles share gives them opposite values, exactly.
float edgeFunction(vec3 from, vec3 to, vec3 direction) {
    return dot(cross(from - to, from + to), direction);
}

// `origin`, `direction`: of the ray in world space, of which transparent surfaces take their random numbers.
// Of two surfaces that coincide, as the layers of a leaf, the front is met: which of them is the nearer is a matter of
// rounding. twin: src/core/bvh/bvh_rays.cpp, RayScene::closestHit.
bool isNearer(float meters, bool backFace, BvhHit nearest) {
    bool coincides = nearest.triangle >= 0 && abs(meters - nearest.distance) <= kCoincident * nearest.distance;
    return coincides && backFace != nearest.backFace ? nearest.backFace : meters < nearest.distance;
}

void testTriangle(int index, LocalRay ray, vec3 origin, vec3 direction, inout BvhHit nearest) {
    uvec4 p = texelFetch(bvhTriangles, tableTexel(2 * index), 0);
    uvec4 q = texelFetch(bvhTriangles, tableTexel(2 * index + 1), 0);
    uvec4 low = p & 15u;
    uvec3 high = q.xyz & 15u;
    uint last = (low.x << 4u) | (low.y << 8u) | (low.z << 12u) | (low.w << 16u) | (high.x << 20u) | (high.y << 24u) |
                (high.z << 28u);
    vec3 sixteenth = bvhGridStep / 16.0;
    vec3 a = gridPoint(p.xyz) * sixteenth - ray.origin;
    vec3 b = gridPoint(uvec3(p.w, q.xy)) * sixteenth - ray.origin;
    vec3 c = gridPoint(uvec3(q.zw, last)) * sixteenth - ray.origin;
    vec3 d = ray.direction;
    vec3 edges = vec3(edgeFunction(c, a, d), edgeFunction(a, b, d), edgeFunction(b, c, d));
    float sum = edges.x + edges.y + edges.z, margin = abs(sum) * kEdgeRounding;
    float least = min(edges.x, min(edges.y, edges.z)), most = max(edges.x, max(edges.y, edges.z));
    if (least < -margin && most > margin) return;
    vec3 normal = cross(b - a, c - a);
    float along = dot(normal, d);
    if (along == 0.0 || sum == 0.0) return;
    float meters = dot(a, normal) / along;
    bool backFace = (along > 0.0) != ray.mirrored;
    if (!(meters > 0.0 && isNearer(meters, backFace, nearest))) return;
    vec2 barycentric = edges.xy / sum;
#ifdef BVH_OPACITY
    if (index >= bvhFirstTransparent && passesThrough(index - bvhFirstTransparent, barycentric, origin, direction))
        return;
#endif
    nearest = BvhHit(meters, index, barycentric, backFace);
}

// Triangle of the first of a leaf. `before`: the bits of the children before it, `c`: the node's last texel.
int firstTriangle(uvec4 c, uint leaf, uint innerChildren) {
    uint before = c.z & ((1u << (2u * leaf)) - 1u);
    return int(c.w + (before & 3u) + ((before >> 2u) & 3u) + ((before >> 4u) & 3u) + leaf - innerChildren);
}

// The nearest hit with 0 < distance < maxDistance or, with `stopAtFirst`, one of the hits.
BvhHit traceBvh(vec3 origin, vec3 direction, float maxDistance, bool stopAtFirst) {
    BvhHit nearest = BvhHit(maxDistance, -1, vec2(0.0), false);
    LocalRay ray = localRay(origin, direction);
    // Words: first inner child of a node << 8 | how many are left to visit << 6 | their ranks, 2 bits each.
    uint stack[kBvhStackWords];
    int size = 0;
    int outside = -1;  // the stack's size where the ray leaves the instance that it is in
    uint node = uint(bvhRoot);
    for (int visit = 0; visit < kMaxVisits; ++visit) {
        uvec4 a = nodeTexel(node, 0);
        uint innerChildren = a.w >> 24u;
        if (innerChildren == kInstance) {
            ray = instanceRay(a, origin, direction);
            outside = size;
            node = a.x;
            continue;
        }
        uvec4 c = nodeTexel(node, 2);
        uvec4 keys = childKeys(a, nodeTexel(node, 1), c, ray, nearest.distance);
        uint inner = 0u, innerCount = 0u;  // ranks of inner children, nearest in the lowest bits
        // A step is an inner child or a triangle, so that rays that are traced together wait little for each other.
        int triangle = 0, last = -1;
        for (int i = 0; i < kMaxSteps; ++i) {
            if (triangle > last) {
                uint key = keys.x;
                keys = uvec4(keys.yzw, kMissed);
                if (key == kMissed || (key & ~3u) > floatBitsToUint(nearest.distance)) break;
                uint child = key & 3u;
                if (child < innerChildren) {
                    inner |= child << (2u * innerCount);
                    ++innerCount;
                    continue;
                }
                triangle = firstTriangle(c, child, innerChildren);
                last = triangle + int((c.z >> (2u * child)) & 3u);
            }
            testTriangle(triangle, ray, origin, direction, nearest);
            ++triangle;
        }
        if (stopAtFirst && nearest.triangle >= 0) break;
        if (innerCount > 0u) {
            node = (c.z >> 8u) + (inner & 3u);
            if (innerCount > 1u && size < kBvhStackWords)
                stack[size++] = (c.z & ~255u) | ((innerCount - 1u) << 6u) | (inner >> 2u);
            continue;
        }
        if (size == outside) {
            ray = localRay(origin, direction);
            outside = -1;
        }
        if (size == 0) break;
        uint top = stack[size - 1], left = (top >> 6u) & 3u;
        node = (top >> 8u) + (top & 3u);
        if (left == 1u)
            --size;
        else
            stack[size - 1] = (top & ~255u) | ((left - 1u) << 6u) | ((top >> 2u) & 15u);
    }
    return nearest;
}

BvhHit closestHit(vec3 origin, vec3 direction, float maxDistance) {
    return traceBvh(origin, direction, maxDistance, false);
}

bool anyHit(vec3 origin, vec3 direction, float maxDistance) {
    return traceBvh(origin, direction, maxDistance, true).triangle >= 0;
}
