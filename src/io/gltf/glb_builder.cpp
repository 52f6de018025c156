#include "io/gltf/glb_builder.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace phat {
namespace {

using nlohmann::json;

constexpr size_t kAlignment = 4;

size_t aligned(size_t size) {
    return (size + kAlignment - 1) / kAlignment * kAlignment;
}

void appendWord(std::vector<uint8_t>& bytes, size_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(uint8_t(value >> shift));
}

void appendChunk(std::vector<uint8_t>& bytes, const char* type, std::span<const uint8_t> content,
                 uint8_t pad) {
    appendWord(bytes, aligned(content.size()));
    bytes.insert(bytes.end(), type, type + 4);
    bytes.insert(bytes.end(), content.begin(), content.end());
    bytes.resize(aligned(bytes.size()), pad);
}

}  // namespace

size_t appendBufferView(GlbBuilder& glb, std::span<const uint8_t> bytes, ViewTarget target,
                        uint32_t byteStride) {
    glb.bin.resize(aligned(glb.bin.size()));
    json view = {{"buffer", 0}, {"byteOffset", glb.bin.size()}, {"byteLength", bytes.size()}};
    if (target != ViewTarget::none) view["target"] = uint32_t(target);
    if (byteStride != 0) view["byteStride"] = byteStride;
    glb.bin.insert(glb.bin.end(), bytes.begin(), bytes.end());
    json& views = glb.json["bufferViews"];
    views.push_back(std::move(view));
    return views.size() - 1;
}

void replaceBufferView(GlbBuilder& glb, size_t view, std::span<const uint8_t> bytes) {
    const auto beginOf = [](const json& v) { return v.value("byteOffset", size_t(0)); };
    const auto endOf = [&](const json& v) { return beginOf(v) + v.at("byteLength").get<size_t>(); };
    json& views = glb.json.at("bufferViews");
    json& replaced = views.at(view);
    const size_t begin = beginOf(replaced), end = std::min(aligned(endOf(replaced)), glb.bin.size());
    const bool shared = std::any_of(views.begin(), views.end(), [&](const json& other) {
        return &other != &replaced && beginOf(other) < end && endOf(other) > begin;
    });
    // Later views move by whole words, which keeps their alignment.
    if (!shared && begin % kAlignment == 0 && end % kAlignment == 0 && begin < end) {
        glb.bin.erase(glb.bin.begin() + ptrdiff_t(begin), glb.bin.begin() + ptrdiff_t(end));
        for (json& other : views)
            if (&other != &replaced && beginOf(other) >= end)
                other["byteOffset"] = beginOf(other) - (end - begin);
    }
    glb.bin.resize(aligned(glb.bin.size()));
    replaced["byteOffset"] = glb.bin.size();
    replaced["byteLength"] = bytes.size();
    glb.bin.insert(glb.bin.end(), bytes.begin(), bytes.end());
}

size_t appendAccessor(GlbBuilder& glb, json accessor, std::span<const uint8_t> bytes, ViewTarget target) {
    const size_t count = accessor.at("count").get<size_t>();
    const size_t size = bytes.size() / count;
    if (target == ViewTarget::vertices && size % kAlignment != 0) {
        const size_t stride = aligned(size);
        std::vector<uint8_t> padded(count * stride);
        for (size_t i = 0; i < count; ++i) std::memcpy(&padded[i * stride], &bytes[i * size], size);
        accessor["bufferView"] = appendBufferView(glb, padded, target, uint32_t(stride));
    } else {
        accessor["bufferView"] = appendBufferView(glb, bytes, target);
    }
    json& accessors = glb.json["accessors"];
    accessors.push_back(std::move(accessor));
    return accessors.size() - 1;
}

std::vector<uint8_t> glbBytes(const GlbBuilder& glb) {
    json described = glb.json;
    if (!glb.bin.empty()) described["buffers"][0] = {{"byteLength", aligned(glb.bin.size())}};
    for (const char* array : {"bufferViews", "accessors"})
        if (described.contains(array) && described[array].empty()) described.erase(array);
    // File names of any encoding may have come in; glTF asks for UTF-8.
    const std::string text = described.dump(-1, ' ', false, json::error_handler_t::replace);

    const size_t total = 12 + 8 + aligned(text.size()) + (glb.bin.empty() ? 0 : 8 + aligned(glb.bin.size()));
    if (total > std::numeric_limits<uint32_t>::max())
        throw std::runtime_error("would be larger than the 4 GiB that a GLB file can be");
    std::vector<uint8_t> bytes;
    bytes.reserve(total);
    for (const char c : {'g', 'l', 'T', 'F'}) bytes.push_back(uint8_t(c));
    appendWord(bytes, 2);
    appendWord(bytes, total);
    appendChunk(bytes, "JSON", {reinterpret_cast<const uint8_t*>(text.data()), text.size()}, ' ');
    if (!glb.bin.empty()) appendChunk(bytes, "BIN\0", glb.bin, 0);
    return bytes;
}

}  // namespace phat
