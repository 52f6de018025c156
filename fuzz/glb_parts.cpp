#include "glb_parts.h"

#include <cstring>

namespace phat::fuzz {
namespace {

constexpr uint32_t kMagic = 0x46546C67, kVersion = 2;  // "glTF"
constexpr uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr size_t kHeader = 12, kChunkHeader = 8;

uint32_t word(std::span<const uint8_t> bytes, size_t at) {
    uint32_t value;
    std::memcpy(&value, &bytes[at], sizeof(value));
    return value;
}

void append(std::vector<uint8_t>& out, uint32_t value) {
    out.resize(out.size() + sizeof(value));
    std::memcpy(&out[out.size() - sizeof(value)], &value, sizeof(value));
}

void appendChunk(std::vector<uint8_t>& out, uint32_t type, std::span<const uint8_t> bytes, uint8_t padding) {
    const size_t padded = (bytes.size() + 3) / 4 * 4;
    append(out, uint32_t(padded));
    append(out, type);
    out.insert(out.end(), bytes.begin(), bytes.end());
    out.resize(out.size() + padded - bytes.size(), padding);
}

}  // namespace

std::optional<GlbParts> partsOfGlb(std::span<const uint8_t> bytes) {
    constexpr size_t kJsonBegin = kHeader + kChunkHeader;
    if (bytes.size() < kJsonBegin || word(bytes, 0) != kMagic) return std::nullopt;
    const size_t jsonBytes = word(bytes, kHeader);
    if (jsonBytes > bytes.size() - kJsonBegin) return std::nullopt;
    GlbParts parts;
    const auto text = bytes.subspan(kJsonBegin, jsonBytes);
    parts.json = nlohmann::json::parse(text.begin(), text.end(), nullptr, /*allow_exceptions=*/false);
    if (!parts.json.is_object()) return std::nullopt;
    const auto rest = bytes.subspan(kJsonBegin + jsonBytes);
    if (rest.size() < kChunkHeader) return parts;
    const auto binary =
        rest.subspan(kChunkHeader, std::min<size_t>(word(rest, 0), rest.size() - kChunkHeader));
    parts.binary.assign(binary.begin(), binary.end());
    return parts;
}

size_t writeGlb(const GlbParts& parts, uint8_t* data, size_t maxSize) {
    const std::string text = parts.json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    std::vector<uint8_t> out;
    for (const uint32_t value : {kMagic, kVersion, 0u}) append(out, value);
    appendChunk(out, kJsonChunk, {reinterpret_cast<const uint8_t*>(text.data()), text.size()}, ' ');
    if (!parts.binary.empty()) appendChunk(out, kBinaryChunk, parts.binary, 0);
    const uint32_t total = uint32_t(out.size());
    std::memcpy(&out[8], &total, sizeof(total));
    if (out.size() > maxSize) return 0;
    std::memcpy(data, out.data(), out.size());
    return out.size();
}

}  // namespace phat::fuzz
