#pragma once
// A glTF file as stored on disk: JSON and buffers, uninterpreted. The loader turns it into a Scene, the
// journal takes its fingerprint and the baked file is rewritten from it, so a command reads and parses its
// input once. All but openGltf throw std::runtime_error with the reason; the callers know the path.

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace phat {

struct GltfSource {
    std::string path;
    nlohmann::json json;                         // an object, of bounded depth
    std::vector<std::vector<uint8_t>> buffers;   // empty until they are read
    std::vector<std::string> bufferProblems;     // why one of them has no data; "" or missing: it has
    std::optional<std::vector<uint8_t>> binary;  // the GLB's BIN chunk until it becomes a buffer
    uint64_t fileBytes = 0;                      // of the JSON text and the BIN chunk
};

/// Reads and parses the file itself; the files that it names are not opened. Throws FileError.
GltfSource openGltf(const std::string& path);

/// Reads the buffers as they are. loadGltf reads them too, within its limits. pre: they are not read yet.
void readGltfBuffers(GltfSource& source);

/// The folder that URIs are relative to.
std::filesystem::path gltfFolder(const GltfSource& source);

/// The target of a `uri` of the file: a data URI, or a file in the scene's folder.
std::vector<uint8_t> readGltfUri(const GltfSource& source, const std::string& uri);

/// object[key] as a whole number, `fallback` where it is absent.
uint64_t wholeNumber(const nlohmann::json& object, const char* key, std::optional<uint64_t> fallback = {});

/// Element `index` of the top-level array `array`.
const nlohmann::json& gltfItem(const nlohmann::json& json, const char* array, uint64_t index);

/// Throws the reason where the buffer could not be read.
std::span<const uint8_t> bufferBytes(const GltfSource& source, uint64_t buffer);

std::span<const uint8_t> bufferViewBytes(const GltfSource& source, uint64_t view);

/// Elements of an accessor side by side: strides and sparse storage undone, values untouched.
struct AccessorElements {
    std::vector<uint8_t> bytes;
    uint64_t count = 0;
    uint32_t elementSize = 0;    // bytes, with the padding of matrix columns
    uint32_t componentType = 0;  // GL enumeration, as in the file
    uint32_t components = 0;
};
/// `expectedCount`, if given, must be the accessor's.
AccessorElements readAccessor(const GltfSource& source, uint64_t accessor,
                              std::optional<uint64_t> expectedCount = {});

/// The vertices of a primitive's triangles, strips and fans taken apart (specification, section 3.7.2.1).
/// Throws where an index is not below `vertexCount`.
std::vector<std::array<uint32_t, 3>> primitiveTriangles(const GltfSource& source,
                                                        const nlohmann::json& primitive,
                                                        uint32_t vertexCount);

/// For each triangle of a surface, in the scene's order: which vertices of the file's primitive its corners
/// are. Throws where the file does not hold what the scene was loaded from.
struct SurfaceCorners {
    std::vector<std::array<uint32_t, 3>> vertices;
    uint32_t vertexCount = 0;  // of the primitive
    bool swapped = false;      // mirrored node: the loader swaps the last two corners of the file's triangles
};
/// The scene's corner of a triangle for corner `slot` of the file, and the inverse.
inline int swappedCorner(int slot, bool swapped) {
    return swapped && slot > 0 ? 3 - slot : slot;
}
SurfaceCorners surfaceCorners(const GltfSource& source, const Scene& scene, const Surface& surface);

}  // namespace phat
