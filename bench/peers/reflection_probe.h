#pragma once
// A box-projected, prefiltered reflection probe: what engines give glossy surfaces of static rooms.
// source: Karis 2013, "Real Shading in Unreal Engine 4" (prefiltering with n = v = r, split sum); Lagarde and
// Zanuttini 2012, "Local Image-based Lighting With Parallax-corrected Cubemaps" (the box).

#include <vector>

#include "core/base/progress.h"
#include "core/scene/lights.h"
#include "core/scene/scene.h"
#include "core/scene/shading.h"
#include "core/transport/path.h"

namespace phat::peers {

/// A cube map of the light that was reflected at least once, as it arrives at `position`.
struct ReflectionProbe {
    glm::vec3 position{0};
    Bounds box;  // what its pictures are projected onto; holds `position`
    int faceSize = 0;
    std::vector<glm::vec3> radiance;  // [face][y][x], rounded to RGB9E5
};

/// Largest cube whose faces, 4 bytes a texel with their mip levels, fit in so many bytes; at least 1.
int probeFaceSize(uint64_t bytes);
uint64_t probeBytes(int faceSize);

struct ProbeSettings {
    glm::vec3 position{0};
    Bounds box;
    int faceSize = 64;
    PathSettings paths;
    uint64_t seed = 1;
};

ReflectionProbe bakeProbe(const RayScene& rays, const LightSampler& lights, const ProbeSettings& settings,
                          Progress& progress);

/// Bilinear within a face. pre: |direction| = 1.
glm::vec3 probeRadiance(const ReflectionProbe& probe, glm::vec3 direction);

/// Where light that reaches `position` along `direction` from the box is in the cube map; unit.
glm::vec3 boxProjected(const ReflectionProbe& probe, glm::vec3 position, glm::vec3 direction);

/// The specular lobe's light: its albedo times the cube map prefiltered around the mirrored eye. Engines
/// store a few prefiltered levels and read between them; here the level is exactly the material's.
glm::vec3 shadeByProbe(const ReflectionProbe& probe, const SurfacePoint& point, glm::vec3 towardEye);

}  // namespace phat::peers
