#pragma once
// Payload streams of a baked file: arrays as zlib streams (docs/format.md, "Payloads").

#include <bit>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "core/base/progress.h"

namespace phat {

/// A zlib stream (RFC 1950), which a browser's DecompressionStream("deflate") undoes. No rearrangement
/// before: bit fields of PHATexels do not end at bytes, and splitting bytes into planes made them larger
/// (format.md). Throws Interrupted when `progress` was asked to stop.
std::vector<uint8_t> encodePayload(std::span<const uint8_t> bytes, const Progress* progress = nullptr);

/// Undoes encodePayload. Throws std::runtime_error, before memory is allocated, when a stream of this length
/// cannot hold `byteLength` bytes; and when it does not hold exactly these.
std::vector<uint8_t> decodePayload(std::span<const uint8_t> stream, size_t byteLength);

/// The bytes of an array of plain values. The file is little endian, as glTF is.
template <class T>
std::span<const uint8_t> bytesOf(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T> && std::endian::native == std::endian::little);
    return {reinterpret_cast<const uint8_t*>(values.data()), values.size_bytes()};
}
template <class T>
std::span<const uint8_t> bytesOf(const std::vector<T>& values) {
    return bytesOf(std::span<const T>(values));
}

}  // namespace phat
