#pragma once
// What every later stage relies on.

#include "core/scene/scene.h"

namespace phat::fuzz {

/// Indices in range, arrays of the same length, numbers finite.
void expectConsistent(const Scene& scene);

}  // namespace phat::fuzz
