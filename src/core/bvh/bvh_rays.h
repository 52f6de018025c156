#pragma once
// Ray queries against the trees that shaders traverse, with the same arithmetic in the same order.
// twin: shaders/lib/bvh.glsl.

#include "core/bvh/posed_bvh.h"
#include "core/scene/rays.h"

namespace phat {

/// What rays have read.
struct BvhReads {
    uint64_t nodes = 0;      // three texels each
    uint64_t triangles = 0;  // two texels each
    uint64_t instances = 0;  // one texel, and three of the matrix

    uint64_t texels() const { return 3 * nodes + 2 * triangles + 4 * instances; }
};

/// Answers as RayScene does, but for ties: of hits of one side at the same distance, within rounding, either
/// may win. A corner may be off by BvhGrid::maxError().
class BvhRays {
  public:
    /// `scene`: as it is now; its materials say what lets rays pass. All of them must outlive this.
    BvhRays(const Scene& scene, const SceneBvh& bvh, const PosedBvh& posed)
        : scene_(&scene), bvh_(&bvh), posed_(&posed) {}

    /// Nearest hit with 0 < distance < maxDistance. pre: |direction| = 1.
    Hit closestHit(const Ray& ray, float maxDistance = kFarDistance, BvhReads* reads = nullptr) const;

    /// Whether anything lies on the open segment. pre: |direction| = 1.
    bool anyHit(const Ray& ray, float maxDistance, BvhReads* reads = nullptr) const;

  private:
    const Scene* scene_;
    const SceneBvh* bvh_;
    const PosedBvh* posed_;
};

}  // namespace phat
