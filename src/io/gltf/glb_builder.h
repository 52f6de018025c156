#pragma once
// A GLB under construction: JSON and one binary buffer that grow together.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace phat {

struct GlbBuilder {
    nlohmann::json json;       // "buffers", if any, are others than `bin`; glbBytes sets the first
    std::vector<uint8_t> bin;  // bufferViews start at multiples of 4
};

/// The target of a bufferView (glTF 2.0, section 5.11.5). Payloads and pictures have none.
enum class ViewTarget : uint32_t { none = 0, vertices = 34962, indices = 34963 };

/// Appends the bytes and their bufferView; returns its index. `byteStride` 0: tightly packed.
size_t appendBufferView(GlbBuilder& glb, std::span<const uint8_t> bytes, ViewTarget target = ViewTarget::none,
                        uint32_t byteStride = 0);

/// Replaces the bytes of a bufferView. Those of the old ones that nothing else uses are gone.
void replaceBufferView(GlbBuilder& glb, size_t view, std::span<const uint8_t> bytes);

/// Appends an accessor over a bufferView of its own. `accessor` says componentType, type, count and what else
/// it likes. Elements of vertex attributes are padded to multiples of 4 bytes.
size_t appendAccessor(GlbBuilder& glb, nlohmann::json accessor, std::span<const uint8_t> bytes,
                      ViewTarget target);

/// The container (glTF 2.0, section 4.4). Throws std::runtime_error past its 4 GiB.
std::vector<uint8_t> glbBytes(const GlbBuilder& glb);

}  // namespace phat
