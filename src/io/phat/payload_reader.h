#pragma once
// Arrays of a baked file by the properties that describe them.

#include <fmt/format.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "io/gltf/gltf_source.h"
#include "io/phat/phat_payload.h"

namespace phat {

struct PayloadReader {
    const GltfSource& source;
    // Payloads may share a bufferView; together they may not claim more than the file could hold.
    uint64_t bytesLeft = 0;
};

/// The payload object[key] as `count` values. Throws std::runtime_error where its size is another.
template <class T>
std::vector<T> readPayload(PayloadReader& reader, const nlohmann::json& object, const char* key,
                           uint64_t count) {
    const nlohmann::json& payload = object.at(key);
    const uint64_t byteLength = wholeNumber(payload, "byteLength");
    if (count > ~0ull / sizeof(T) || byteLength != count * sizeof(T))
        throw std::runtime_error(fmt::format("the payload \"{}\" has {} bytes where {} belong", key,
                                             byteLength, count * sizeof(T)));
    if (byteLength > reader.bytesLeft)
        throw std::runtime_error(fmt::format("the payload \"{}\" is larger than the file allows", key));
    reader.bytesLeft -= byteLength;
    const auto stream = bufferViewBytes(reader.source, wholeNumber(payload, "bufferView"));
    const std::vector<uint8_t> bytes = decodePayload(stream, byteLength);
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), bytes.data(), byteLength);
    return values;
}

}  // namespace phat
