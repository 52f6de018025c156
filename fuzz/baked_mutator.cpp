#include <cstring>

#include "glb_parts.h"
#include "io/gltf/gltf_rewrite.h"
#include "io/phat/phat_payload.h"
#include "targets.h"

namespace phat::fuzz {
namespace {

using nlohmann::json;

constexpr size_t kMaxPayloadBytes = 1 << 20;

void collectPayloads(json& value, std::vector<json*>& found) {
    if (!value.is_structured()) return;
    if (value.is_object() && value.contains("bufferView") && value.contains("byteLength"))
        found.push_back(&value);
    for (json& inner : value) collectPayloads(inner, found);
}

json* extensionOf(json& root) {
    const auto extensions = root.find("extensions");
    if (extensions == root.end() || !extensions->is_object()) return nullptr;
    const auto found = extensions->find(kPhatExtension);
    return found == extensions->end() ? nullptr : &*found;
}

// A payload, the view that its stream lies in, and what the stream holds.
struct OpenPayload {
    json& description;
    json& view;
    std::vector<uint8_t> bytes;
};

std::optional<OpenPayload> openPayload(GlbParts& parts, json& description) {
    try {
        json& view = parts.json.at("bufferViews").at(description.at("bufferView").get<size_t>());
        const size_t offset = view.value("byteOffset", size_t(0)), length = view.at("byteLength");
        const size_t byteLength = description.at("byteLength");
        if (byteLength > kMaxPayloadBytes || offset > parts.binary.size() ||
            length > parts.binary.size() - offset)
            return std::nullopt;
        const std::span<const uint8_t> stream(parts.binary.data() + offset, length);
        return OpenPayload{description, view, decodePayload(stream, byteLength)};
    } catch (const std::exception&) {  // an earlier mutation has broken it
        return std::nullopt;
    }
}

// The values of payloads are words, or end at words.
void changeWords(std::vector<uint8_t>& bytes, Rng& rng) {
    constexpr uint32_t kWords[] = {0,          1,          2,          3,          7,          8,
                                   100,        255,        1024,       65535,      0x00800000, 0x3f800000,
                                   0x7f7fffff, 0x7f800000, 0x7fc00000, 0x7fffffff, 0x80000000, ~0u};
    for (size_t left = 1 + below(rng, 4); left > 0 && bytes.size() >= 4; --left) {
        uint8_t* at = &bytes[below(rng, bytes.size() / 4) * 4];
        uint32_t word;
        std::memcpy(&word, at, sizeof(word));
        switch (below(rng, 4)) {
            case 0:
                ++word;
                break;
            case 1:
                --word;
                break;
            case 2:
                word = rng.bits();
                break;
            default:
                word = kWords[below(rng, std::size(kWords))];
        }
        std::memcpy(at, &word, sizeof(word));
    }
}

void changeBytes(OpenPayload& payload, Rng& rng) {
    constexpr size_t kMaxGrowth = 32;
    const size_t size = payload.bytes.size();
    payload.bytes.resize(oneIn(rng, 8) ? size + kMaxGrowth : size);
    payload.bytes.resize(mutateBytes(payload.bytes.data(), size, payload.bytes.size(), rng.bits()));
    if (oneIn(rng, 2))
        payload.bytes.resize(size);
    else
        payload.description["byteLength"] = payload.bytes.size();
}

// Where it was if it fits, else at the end.
void closePayload(GlbParts& parts, const OpenPayload& payload) {
    const std::vector<uint8_t> stream = encodePayload(payload.bytes);
    size_t offset = payload.view.value("byteOffset", size_t(0));
    if (stream.size() > payload.view["byteLength"].get<size_t>()) {
        offset = (parts.binary.size() + 3) / 4 * 4;
        parts.binary.resize(offset + stream.size());
    }
    std::copy(stream.begin(), stream.end(), parts.binary.begin() + ptrdiff_t(offset));
    payload.view["byteOffset"] = offset;
    payload.view["byteLength"] = stream.size();
    json& buffers = parts.json["buffers"];
    if (buffers.is_array() && !buffers.empty() && buffers[0].is_object())
        buffers[0]["byteLength"] = parts.binary.size();
}

bool mutatePayload(GlbParts& parts, json& extension, Rng& rng) {
    std::vector<json*> payloads;
    collectPayloads(extension, payloads);
    if (payloads.empty()) return false;
    std::optional<OpenPayload> payload = openPayload(parts, *payloads[below(rng, payloads.size())]);
    if (!payload || payload->bytes.empty()) return false;
    if (oneIn(rng, 3))
        changeBytes(*payload, rng);
    else
        changeWords(payload->bytes, rng);
    closePayload(parts, *payload);
    return true;
}

}  // namespace

size_t mutateBaked(uint8_t* data, size_t size, size_t maxSize, unsigned seed) {
    Rng rng(seed);
    std::optional<GlbParts> parts = partsOfGlb({data, size});
    json* extension = parts ? extensionOf(parts->json) : nullptr;
    if (!extension || oneIn(rng, 12)) return mutateGltf(data, size, maxSize, seed);
    const bool changed = oneIn(rng, 2) && mutatePayload(*parts, *extension, rng);
    if (!changed || oneIn(rng, 4)) mutateJson(oneIn(rng, 3) ? parts->json : *extension, rng);
    const size_t written = writeGlb(*parts, data, maxSize);
    return written > 0 ? written : mutateBytes(data, size, maxSize, seed);
}

}  // namespace phat::fuzz
