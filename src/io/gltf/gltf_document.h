#pragma once
// A glTF file in memory whose every index and extent is known to be good.

#include "io/gltf/gltf_description.h"
#include "io/gltf/gltf_source.h"

namespace phat::gltf {

struct Document {
    const GltfSource& source;  // with its buffers
    Description description;

    const tinygltf::Model& model() const { return description.model; }
};

/// Reads the buffers of `source` and checks everything. The document refers to `source`. Throws Problem.
/// pre: the buffers are not read yet.
Document checkedDocument(GltfSource& source, MemoryBudget& budget, Notes& notes);

/// Throws Problem when an index, count, offset, stride, matrix, camera or light is not what the specification
/// allows; after it, only accessor contents can surprise.
void checkModel(const Document& document);

/// Bytes of one element of an accessor.
size_t elementSize(const tinygltf::Accessor& accessor);

}  // namespace phat::gltf
