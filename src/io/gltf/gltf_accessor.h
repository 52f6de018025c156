#pragma once
// Accessor contents as floats and indices: sparse, interleaved, normalised, of every component type.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "io/gltf/gltf_document.h"

namespace phat::gltf {

/// Elements with `components` numbers each, one after the other. Integers of a normalised accessor, or of any
/// with `asNormalized`, are mapped to [0,1] or [-1,1] (specification, section 3.11). pre: a checked document;
/// the caller has charged the memory. Throws Problem when the accessor has another shape or a sparse index is
/// out of range.
std::vector<float> readFloats(const Document& document, int accessor, int components,
                              bool asNormalized = false);

/// The same as vectors.
template <int N>
std::vector<glm::vec<N, float>> readVectors(const Document& document, int accessor,
                                            bool asNormalized = false) {
    const std::vector<float> floats = readFloats(document, accessor, N, asNormalized);
    std::vector<glm::vec<N, float>> vectors(floats.size() / N);
    for (size_t i = 0; i < floats.size(); ++i) vectors[i / N][int(i % N)] = floats[i];
    return vectors;
}

/// One number of an accessor; `type` as in the file, integers mapped as above where `normalized`.
float componentOf(const uint8_t* bytes, int type, bool normalized);

/// Vertex indices, each below `vertexCount`. Throws Problem.
std::vector<uint32_t> readIndices(const Document& document, int accessor, size_t vertexCount);

}  // namespace phat::gltf
