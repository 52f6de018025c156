#pragma once
// A glTF file in memory whose every index and extent is known to be good.

#include <filesystem>

#include "io/gltf/gltf_container.h"
#include "io/gltf/gltf_description.h"

namespace phat::gltf {

struct Document {
    std::filesystem::path folder;  // of the file; URIs are relative to it
    Description description;
    std::vector<std::vector<uint8_t>> buffers;

    const tinygltf::Model& model() const { return description.model; }
};

/// Reads and checks. Throws Problem.
Document readDocument(const std::string& path, MemoryBudget& budget, Notes& notes);

/// Throws Problem when an index, count, offset, stride, matrix, camera or light is not what the specification
/// allows; after it, only accessor contents can surprise.
void checkModel(const Document& document);

/// Bytes of one element of an accessor.
size_t elementSize(const tinygltf::Accessor& accessor);

}  // namespace phat::gltf
