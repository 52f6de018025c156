#pragma once
// Arrays of a baked file by the properties that describe them.

#include <fmt/format.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "io/gltf/gltf_problem.h"
#include "io/gltf/gltf_source.h"
#include "io/phat/phat_payload.h"

namespace phat {

struct PayloadReader {
    const GltfSource& source;
    // Of what is read and of what is made from it. Payloads may share a bufferView, and sizes are only
    // claimed.
    gltf::MemoryBudget budget;
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
    reader.budget.charge(byteLength, fmt::format("the payload \"{}\"", key));
    const auto stream = bufferViewBytes(reader.source, wholeNumber(payload, "bufferView"));
    const std::vector<uint8_t> bytes = decodePayload(stream, byteLength);
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), bytes.data(), byteLength);
    return values;
}

}  // namespace phat
