#pragma once
// What shaders need to know whether a ray passes a triangle that is masked or blended.
// twin: shaders/lib/bvh_opacity.glsl.

#include <vector>

#include "core/bvh/scene_bvh.h"

namespace phat {

struct OpacityTables {
    std::vector<glm::uvec4>
        texels;  // three a transparent triangle, in the order of the leaves, three a material
    std::vector<uint8_t> alphas;  // [picture][y][x] of the pictures that transparent materials read
    uint32_t firstMaterial = 0;   // texel of the first material
};

/// `scene`: at rest or not; with the materials as they are now.
OpacityTables opacityTables(const Scene& scene, const SceneBvh& bvh);

}  // namespace phat
