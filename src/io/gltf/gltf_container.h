#pragma once
// The bytes of a .glb or .gltf, and of the files that it may name.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace phat::gltf {

struct Container {
    std::string json;
    std::vector<uint8_t> binary;  // the GLB's BIN chunk
    bool hasBinary = false;
    bool isGlb = false;
};

/// Splits a file by its magic, whatever its extension. Lengths are checked against the file's real size
/// before memory is allocated. Throws Problem.
/// source: glTF 2.0 specification, section 4.4 (binary container).
Container readContainer(const std::string& path);

/// A data URI's payload, or the file that a relative URI names inside `folder`; never more than `maxBytes`.
/// Throws Problem for schemes, paths and links that leave the folder, and what is no plain file.
std::vector<uint8_t> readUri(const std::string& uri, const std::filesystem::path& folder, uint64_t maxBytes);

/// Whether the URI holds its data itself.
bool isDataUri(std::string_view uri);

/// A URI as a message may show it: data URIs and long names are cut.
std::string shortUri(const std::string& uri);

}  // namespace phat::gltf
