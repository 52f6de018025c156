#pragma once
// What the shown scene does without: broken parts of it must not keep a file from opening.

#include "io/gltf/gltf_source.h"

namespace phat::gltf {

/// Replaces every element that the default scene, its materials, its sound animations and the file's own
/// extensions do not reach by a harmless one of the same index. Returns whether anything changed. pre: the
/// buffers are read.
bool leaveOutUnused(GltfSource& source);

}  // namespace phat::gltf
