#include "io/gltf/gltf_document.h"

#include <fmt/core.h>

namespace phat::gltf {
namespace {

std::vector<std::vector<uint8_t>> readBuffers(Container& container, const Description& description,
                                              const std::filesystem::path& folder, MemoryBudget& budget) {
    std::vector<std::vector<uint8_t>> buffers;
    for (size_t i = 0; i < description.buffers.size(); ++i) {
        const BufferEntry& entry = description.buffers[i];
        std::vector<uint8_t> bytes;
        if (!entry.uri.empty()) {
            // The same file may be named many times, so what it takes counts.
            bytes = readUri(entry.uri, folder, std::min(entry.byteLength, budget.left()));
            budget.charge(bytes.size(), "the buffers");
        } else if (i == 0 && container.hasBinary) {
            bytes = std::move(container.binary);
        } else {
            throw Problem(fmt::format("buffer {} has neither a URI nor a binary chunk", i));
        }
        if (bytes.size() < entry.byteLength) {
            throw Problem(
                fmt::format("buffer {} has {} bytes instead of {}", i, bytes.size(), entry.byteLength));
        }
        buffers.push_back(std::move(bytes));
    }
    return buffers;
}

}  // namespace

Document readDocument(const std::string& path, MemoryBudget& budget, Notes& notes) {
    Container container = readContainer(path);
    budget.allowFor(container.json.size() + container.binary.size());

    Document document;
    document.folder = std::filesystem::path(path).parent_path();
    if (document.folder.empty()) document.folder = ".";
    document.description = parseDescription(container.json, budget, notes);
    container.json = {};
    document.buffers = readBuffers(container, document.description, document.folder, budget);
    checkModel(document);
    return document;
}

}  // namespace phat::gltf
