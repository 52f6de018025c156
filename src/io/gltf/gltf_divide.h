#pragma once

#include <span>

#include "core/atlas/divided_surfaces.h"
#include "io/gltf/gltf_problem.h"
#include "io/gltf/gltf_source.h"

namespace phat::gltf {

/// Makes the parts of divided surfaces primitives: the first in place of the surface's own, the others behind
/// those of its mesh. A mesh that several nodes show is copied for the node whose surface is divided. `scene`
/// was loaded from `source`, which is plain (gltf_plain.h). Throws std::runtime_error.
void dividePrimitives(GltfSource& source, const Scene& scene, std::span<const DividedSurface> divided,
                      MemoryBudget& budget);

}  // namespace phat::gltf
