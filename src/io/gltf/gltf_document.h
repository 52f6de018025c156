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

/// Reads the buffers within the budget. One that cannot be read is remembered in `bufferProblems`, for those
/// who need it. Throws Problem where they are not described. pre: they are not read yet.
void readBuffers(GltfSource& source, MemoryBudget& budget);

/// Checks everything. The document refers to `source`. Throws Problem. pre: the buffers are read, the file is
/// plain (gltf_plain.h).
Document checkedDocument(const GltfSource& source, MemoryBudget& budget, Notes& notes);

/// Throws Problem when an index, count, offset, stride or matrix is not what the specification
/// allows; after it, only accessor contents can surprise.
void checkModel(const Document& document);

/// Bytes of one element of an accessor.
size_t elementSize(const tinygltf::Accessor& accessor);

}  // namespace phat::gltf
