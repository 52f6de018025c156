#include "core/bvh/bvh_rays.h"

#include <array>
#include <bit>
#include <cassert>

#include "core/scene/ray_opacity.h"

namespace phat {
namespace {

/// Components of directions that are nearer to 0 are taken for this, so that nothing is divided by 0.
constexpr float kMinComponent = 0x1p-64f;
/// Of the distances to a box's planes: twice what rounding may do to them. source: Ize 2013, "Robust BVH Ray
/// Traversal".
constexpr float kSlabRounding = 0x1p-21f;
/// Of the sum of a triangle's three edge functions, by which one of them may be on the wrong side.
constexpr float kEdgeRounding = 0x1p-22f;
/// Of the distance: surfaces so near to each other coincide.
constexpr float kCoincident = 0x1p-18f;
constexpr uint32_t kMissed = ~0u;
/// Nodes that a ray may visit: a guard for the shader's loop that no scene comes near.
constexpr int kMaxVisits = 1 << 16;

// A ray in the space of the tree that is being traversed.
struct LocalRay {
    glm::vec3 origin, direction, inverse;
    bool mirrored = false;

    LocalRay(glm::vec3 from, glm::vec3 along) : origin(from), direction(along) {
        for (int axis = 0; axis < 3; ++axis) {
            const float d = along[axis];
            inverse[axis] = 1.0f / (std::abs(d) >= kMinComponent ? d
                                    : d < 0                      ? -kMinComponent
                                                                 : kMinComponent);
        }
    }
};

struct Nearest {
    float distance;
    uint32_t triangle = kNoTriangle;  // in the order of the leaves
    glm::vec2 barycentric{0};
    bool backFace = false;
};

// One of a triangle's edge functions: the volume that the ray and an edge span. An edge that two triangles
// share gives them opposite values, exactly, so that no ray slips through between them. source: Shevtsov et
// al. 2007, "Ray-Triangle Intersection Algorithm for Modern CPU Architectures".
float edgeFunction(glm::vec3 from, glm::vec3 to, glm::vec3 direction) {
    return glm::dot(glm::cross(from - to, from + to), direction);
}

class Traversal {
  public:
    Traversal(const Scene& scene, const SceneBvh& bvh, const PosedBvh& posed, const Ray& ray,
              float maxDistance)
        : scene_(scene),
          bvh_(bvh),
          posed_(posed),
          world_(ray),
          local_(ray.origin, ray.direction),
          nearest_{maxDistance} {}

    const BvhReads& reads() const { return reads_; }

    Nearest run(bool stopAtFirst) {
        uint32_t node = posed_.root;
        for (int visit = 0; visit < kMaxVisits; ++visit) {
            if (isInstance(nodeAt(node))) {
                node = enter(BvhInstance::of(nodeAt(node)));
                continue;
            }
            const uint32_t next = visitChildren(node);
            if (stopAtFirst && nearest_.triangle != kNoTriangle) break;
            node = next != kMissed ? next : pop();
            if (node == kMissed) break;
        }
        return nearest_;
    }

  private:
    const BvhNode& nodeAt(uint32_t index) const {
        const size_t atRest = bvh_.nodes.size();
        return index < atRest ? bvh_.nodes[index] : posed_.nodes[index - atRest];
    }

    uint32_t enter(const BvhInstance& instance) {
        ++reads_.instances;
        const auto& words = nodeAt(instance.matrixNode).words;
        glm::vec3 origin, direction;
        for (int row = 0; row < 3; ++row) {
            glm::vec4 m;
            for (int column = 0; column < 4; ++column)
                m[column] = std::bit_cast<float>(words[size_t(4 * row + column)]);
            origin[row] = glm::dot(glm::vec3(m), world_.origin) + m.w;
            direction[row] = glm::dot(glm::vec3(m), world_.direction);
        }
        local_ = LocalRay(origin, direction);
        local_.mirrored = instance.mirrored;
        outside_ = size_;
        return instance.root;
    }

    // Tests the leaves among a node's children, nearest first, and keeps the inner ones. Returns the nearest
    // of those, or kMissed.
    uint32_t visitChildren(uint32_t index) {
        ++reads_.nodes;
        const auto& words = nodeAt(index).words;
        const std::array<uint32_t, kBvhWidth> keys = sortedKeys(words);
        const uint32_t innerChildren = words[3] >> 24;
        uint32_t inner = 0, innerCount = 0;  // ranks of inner children, nearest in the lowest bits
        for (const uint32_t key : keys) {
            if (key == kMissed || (key & ~3u) > std::bit_cast<uint32_t>(nearest_.distance)) break;
            const uint32_t child = key & 3;
            if (child < innerChildren) {
                inner |= child << (2 * innerCount++);
                continue;
            }
            const uint32_t before = words[10] & ((1u << (2 * child)) - 1);
            const uint32_t first =
                words[11] + (before & 3) + (before >> 2 & 3) + (before >> 4 & 3) + (child - innerChildren);
            const uint32_t end = first + 1 + (words[10] >> (2 * child) & 3);
            for (uint32_t i = first; i < end; ++i) testTriangle(i);
        }
        if (innerCount == 0) return kMissed;
        const uint32_t firstInner = words[10] >> 8;
        if (innerCount > 1) {
            assert(size_ < kBvhStackWords);
            stack_[size_t(size_++)] = firstInner << 8 | (innerCount - 1) << 6 | inner >> 2;
        }
        return firstInner + (inner & 3);
    }

    // Where the ray enters the children's boxes, nearest first: the bits of the distance, the lowest two of
    // which are the child's number.
    std::array<uint32_t, kBvhWidth> sortedKeys(const std::array<uint32_t, 12>& words) const {
        glm::vec3 unit, near, far;
        std::array<uint32_t, 3> nearBytes{}, farBytes{};
        for (int axis = 0; axis < 3; ++axis) {
            const size_t a = size_t(axis);
            const float scale = std::bit_cast<float>((words[3] >> (8 * axis) & 255) << 23);
            const float toOrigin =
                (std::bit_cast<float>(words[a]) - local_.origin[axis]) * local_.inverse[axis];
            const float margin = std::abs(toOrigin) * kSlabRounding;
            unit[axis] = scale * local_.inverse[axis];
            near[axis] = toOrigin - margin;
            far[axis] = toOrigin + margin;
            const bool backward = local_.inverse[axis] < 0;
            nearBytes[a] = words[(backward ? 7 : 4) + a];
            farBytes[a] = words[(backward ? 4 : 7) + a];
        }
        std::array<uint32_t, kBvhWidth> keys;
        for (uint32_t child = 0; child < kBvhWidth; ++child) {
            glm::vec3 in, out;
            for (int axis = 0; axis < 3; ++axis) {
                in[axis] = float(nearBytes[size_t(axis)] >> (8 * child) & 255) * unit[axis] + near[axis];
                out[axis] = float(farBytes[size_t(axis)] >> (8 * child) & 255) * unit[axis] + far[axis];
            }
            const float entry = std::max(std::max(in.x, in.y), std::max(in.z, 0.0f));
            const float exit = std::min(std::min(out.x, out.y), std::min(out.z, nearest_.distance));
            const bool met = entry <= exit * (1.0f + kSlabRounding);
            keys[child] = met ? (std::bit_cast<uint32_t>(entry) & ~3u) | child : kMissed;
        }
        const auto sort = [&](size_t a, size_t b) {
            const uint32_t low = std::min(keys[a], keys[b]);
            keys[b] = std::max(keys[a], keys[b]);
            keys[a] = low;
        };
        sort(0, 1);
        sort(2, 3);
        sort(0, 2);
        sort(1, 3);
        sort(1, 2);
        return keys;
    }

    // Of two surfaces that coincide, as the layers of a leaf, the front is met: which of them is the nearer
    // is a matter of rounding. As by RayScene::closestHit.
    bool isNearer(float distance, bool backFace) const {
        const bool coincides = nearest_.triangle != kNoTriangle &&
                               std::abs(distance - nearest_.distance) <= kCoincident * nearest_.distance;
        return coincides && backFace != nearest_.backFace ? nearest_.backFace : distance < nearest_.distance;
    }

    void testTriangle(uint32_t index) {
        ++reads_.triangles;
        auto [a, b, c] = cornersOf(bvh_.grid, bvh_.triangles[index]);
        a -= local_.origin;
        b -= local_.origin;
        c -= local_.origin;
        const glm::vec3 d = local_.direction;
        const glm::vec3 edges(edgeFunction(c, a, d), edgeFunction(a, b, d), edgeFunction(b, c, d));
        const float sum = edges.x + edges.y + edges.z, margin = std::abs(sum) * kEdgeRounding;
        const float least = std::min(edges.x, std::min(edges.y, edges.z));
        const float most = std::max(edges.x, std::max(edges.y, edges.z));
        if (least < -margin && most > margin) return;
        const glm::vec3 normal = glm::cross(b - a, c - a);
        const float along = glm::dot(normal, d);
        if (along == 0.0f || sum == 0.0f) return;
        const float distance = glm::dot(a, normal) / along;
        const bool backFace = (along > 0.0f) != local_.mirrored;
        if (!(distance > 0.0f && isNearer(distance, backFace))) return;
        const glm::vec2 barycentric = glm::vec2(edges) / sum;
        if (index >= bvh_.firstTransparent &&
            passesThrough(scene_, bvh_.order[index], barycentric, world_.origin, world_.direction))
            return;
        nearest_ = {distance, index, barycentric, backFace};
    }

    // The next node to visit, or kMissed.
    uint32_t pop() {
        if (size_ == outside_) {
            local_ = LocalRay(world_.origin, world_.direction);
            outside_ = -1;
        }
        if (size_ == 0) return kMissed;
        uint32_t& top = stack_[size_t(size_ - 1)];
        const uint32_t node = (top >> 8) + (top & 3), left = top >> 6 & 3;
        if (left == 1)
            --size_;
        else
            top = (top & ~255u) | (left - 1) << 6 | (top >> 2 & 15);
        return node;
    }

    const Scene& scene_;
    const SceneBvh& bvh_;
    const PosedBvh& posed_;
    const Ray& world_;
    LocalRay local_;
    Nearest nearest_;
    BvhReads reads_;
    // Words: first inner child of a node << 8 | how many are left to visit << 6 | their ranks, 2 bits each.
    std::array<uint32_t, kBvhStackWords> stack_{};
    int size_ = 0;
    int outside_ = -1;  // the stack's size where the ray leaves the instance that it is in
};

void add(BvhReads* sum, const BvhReads& reads) {
    if (!sum) return;
    sum->nodes += reads.nodes;
    sum->triangles += reads.triangles;
    sum->instances += reads.instances;
}

}  // namespace

Hit BvhRays::closestHit(const Ray& ray, float maxDistance, BvhReads* reads) const {
    assert(isUnit(ray.direction));
    Traversal traversal(*scene_, *bvh_, *posed_, ray, maxDistance);
    const Nearest nearest = traversal.run(false);
    add(reads, traversal.reads());
    if (nearest.triangle == kNoTriangle) return {};
    return {nearest.distance, bvh_->order[nearest.triangle], nearest.barycentric, nearest.backFace};
}

bool BvhRays::anyHit(const Ray& ray, float maxDistance, BvhReads* reads) const {
    assert(isUnit(ray.direction));
    Traversal traversal(*scene_, *bvh_, *posed_, ray, maxDistance);
    const bool hit = traversal.run(true).triangle != kNoTriangle;
    add(reads, traversal.reads());
    return hit;
}

}  // namespace phat
