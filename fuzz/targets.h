#pragma once
// What is fuzzed: each target reads a file of these bytes, as the program would, and throws where a reader
// does not keep its promise: FileError is the only exception that it may throw, and what it returns is
// consistent.

#include <cstddef>
#include <cstdint>
#include <span>

namespace phat::fuzz {

using Bytes = std::span<const uint8_t>;

/// A glTF file, loaded as a scene.
void gltf(Bytes bytes);
/// A baked file: its payloads decoded, and split for a page.
void baked(Bytes bytes);
/// PNG, JPEG, Radiance HDR and OpenEXR as files, and PNG, JPEG, WebP and AVIF as the textures of a scene.
void picture(Bytes bytes);
/// The journal of a bake, resumed.
void journal(Bytes bytes);

/// A photometric file of LM-63.
void ies(Bytes bytes);

/// A mutation of the first `size` bytes in place, with room for `maxSize`; returns the new size. The formats'
/// checksums, lengths and compression hold again afterwards: bytes that are changed at random are refused
/// early.
size_t mutateGltf(uint8_t* data, size_t size, size_t maxSize, unsigned seed);
size_t mutateBaked(uint8_t* data, size_t size, size_t maxSize, unsigned seed);
size_t mutateJournal(uint8_t* data, size_t size, size_t maxSize, unsigned seed);
/// The fuzzer's own.
size_t mutateBytes(uint8_t* data, size_t size, size_t maxSize, unsigned seed);

}  // namespace phat::fuzz
