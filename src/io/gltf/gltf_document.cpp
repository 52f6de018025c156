#include "io/gltf/gltf_document.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <utility>

#include "io/gltf/gltf_container.h"

namespace phat::gltf {
namespace {

using nlohmann::json;

std::vector<uint8_t> bufferData(GltfSource& source, const json& buffer, size_t index, MemoryBudget& budget) {
    const uint64_t byteLength = wholeNumber(buffer, "byteLength");
    const std::string uri = buffer.value("uri", "");
    std::vector<uint8_t> bytes;
    if (!uri.empty()) {
        // The same file may be named many times, so what it takes counts.
        bytes = readUri(uri, gltfFolder(source), std::min(byteLength, budget.left()));
        budget.charge(bytes.size(), "the buffers");
    } else if (index == 0 && source.binary) {
        bytes = *std::exchange(source.binary, std::nullopt);
    } else {
        throw Problem(fmt::format("buffer {} has neither a URI nor a binary chunk", index));
    }
    if (bytes.size() < byteLength)
        throw Problem(fmt::format("buffer {} has {} bytes instead of {}", index, bytes.size(), byteLength));
    return bytes;
}

}  // namespace

void readBuffers(GltfSource& source, MemoryBudget& budget) {
    assert(source.buffers.empty());
    const auto buffers = source.json.find("buffers");
    if (buffers == source.json.end()) return;
    if (!buffers->is_array()) throw Problem("\"buffers\" is not an array");
    for (size_t i = 0; i < buffers->size(); ++i) {
        std::vector<uint8_t>& bytes = source.buffers.emplace_back();
        std::string& problem = source.bufferProblems.emplace_back();
        try {
            bytes = bufferData(source, gltfItem(source.json, "buffers", i), i, budget);
        } catch (const json::exception&) {
            problem = fmt::format("buffer {} is malformed", i);
        } catch (const std::runtime_error& error) {
            problem = error.what();
        }
    }
}

Document checkedDocument(const GltfSource& source, MemoryBudget& budget, Notes& notes) {
    Document document{source, describe(source.json, budget, notes)};
    checkModel(document);
    return document;
}

}  // namespace phat::gltf
