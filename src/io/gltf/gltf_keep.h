#pragma once
// Carries accessors, bufferViews and images that a rewrite leaves alone from the source into the new file.

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/gltf/glb_builder.h"
#include "io/gltf/gltf_source.h"

namespace phat {

/// New indices of the elements that were carried over, by the old ones.
struct Kept {
    std::map<uint64_t, size_t> views;
    std::map<uint64_t, size_t> accessors;
};

/// Unknown extensions may point at anything: then everything keeps its number, used or not.
/// pre: nothing else is in the new file yet.
void keepAllIfReferencesAreUnknown(const GltfSource& source, GlbBuilder& glb, Kept& kept);

/// Carries over what the new file's JSON still points at by the source's numbers, and puts the new numbers
/// there: animations, skins, images (those beside the source are embedded) and all primitives but
/// `rewrittenPrimitives` (mesh, primitive). Appends to `notes` what could not be read.
void keepReferences(const GltfSource& source, const std::set<std::pair<size_t, size_t>>& rewrittenPrimitives,
                    GlbBuilder& glb, Kept& kept, std::vector<std::string>& notes);

}  // namespace phat
