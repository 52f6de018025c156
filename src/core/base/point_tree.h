#pragma once
// A kd-tree over positions: the adaptor that nanoflann requires.

#include <cstdint>
#include <nanoflann.hpp>
#include <vector>

#include "core/base/math.h"

namespace phat {

/// Positions alone: a search reads 12 bytes of each instead of a cache line.
struct PointCloud {
    std::vector<glm::vec3> points;

    size_t kdtree_get_point_count() const { return points.size(); }
    float kdtree_get_pt(size_t index, size_t axis) const { return points[index][glm::length_t(axis)]; }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using PointTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, PointCloud, float, uint32_t>,
                                        PointCloud, 3, uint32_t>;

}  // namespace phat
