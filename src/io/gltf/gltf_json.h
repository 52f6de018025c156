#pragma once
// Looking things up in glTF JSON that nobody has checked yet, and adding to it.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/gltf/gltf_source.h"

namespace phat::gltf {

/// Of accessors (specification, section 3.6.2.2).
inline constexpr uint32_t kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
                          kUnsignedInt = 5125, kFloat = 5126;

/// object.extensions[name], or null where it is none.
const nlohmann::json* findExtension(const nlohmann::json& object, const char* name);

void eraseExtension(nlohmann::json& object, const char* name);

/// Takes the name out of extensionsUsed and extensionsRequired.
void forgetExtension(nlohmann::json& gltf, const char* name);

/// Puts the name into extensionsUsed.
void useExtension(nlohmann::json& gltf, const char* name);

/// The elements of a top-level array; empty where there is none.
size_t countOf(const nlohmann::json& gltf, const char* array);

/// The nodes of the default scene, or all where there is none, parents before children. `withHidden`: also
/// those that KHR_node_visibility hides. Throws where a node does not exist.
std::vector<uint64_t> sceneNodes(const nlohmann::json& gltf, bool withHidden);

/// The parent of each node; -1: it has none. Throws where the children are no indices.
std::vector<int64_t> parentNodes(const nlohmann::json& gltf);

/// Takes samplers out of an animation whose accessors cannot be read, and channels of those or of nodes that
/// do not exist. Returns how many channels went.
size_t dropBrokenChannels(const GltfSource& source, nlohmann::json& animation);

/// Keeps the bytes as one more buffer and returns the bufferView of them. `byteStride` 0: tightly packed.
size_t addBufferView(GltfSource& source, std::vector<uint8_t> bytes, uint32_t byteStride = 0);

/// The same with an accessor; `accessor` says componentType, type and count.
size_t addAccessor(GltfSource& source, nlohmann::json accessor, std::vector<uint8_t> bytes,
                   uint32_t byteStride = 0);

/// An accessor over floats, `components` an element.
size_t addFloats(GltfSource& source, const std::vector<float>& values, uint32_t components);

/// An accessor over vertex indices.
size_t addIndices(GltfSource& source, std::span<const uint32_t> indices);

/// A mesh that several nodes show is copied for each of them that has one of the surfaces. Returns the mesh
/// of each surface.
std::vector<size_t> giveNodesTheirOwnMeshes(nlohmann::json& gltf, std::span<const Surface> surfaces);

/// Numbers of an accessor, `components` an element; integers of a normalised accessor, or of any with
/// `asNormalized`, are mapped to [0,1] or [-1,1]. `expectedCount`: see readAccessor.
std::vector<float> accessorFloats(const GltfSource& source, uint64_t accessor, uint32_t components,
                                  bool asNormalized = false, std::optional<uint64_t> expectedCount = {});

}  // namespace phat::gltf
