#include "io/gltf/gltf_document.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <utility>

#include "io/gltf/gltf_container.h"

namespace phat::gltf {
namespace {

void readBuffers(const Description& description, GltfSource& source, MemoryBudget& budget) {
    assert(source.buffers.empty());
    for (size_t i = 0; i < description.buffers.size(); ++i) {
        const BufferEntry& entry = description.buffers[i];
        std::vector<uint8_t> bytes;
        if (!entry.uri.empty()) {
            // The same file may be named many times, so what it takes counts.
            bytes = readUri(entry.uri, gltfFolder(source), std::min(entry.byteLength, budget.left()));
            budget.charge(bytes.size(), "the buffers");
        } else if (i == 0 && source.binary) {
            bytes = *std::exchange(source.binary, std::nullopt);
        } else {
            throw Problem(fmt::format("buffer {} has neither a URI nor a binary chunk", i));
        }
        if (bytes.size() < entry.byteLength) {
            throw Problem(
                fmt::format("buffer {} has {} bytes instead of {}", i, bytes.size(), entry.byteLength));
        }
        source.buffers.push_back(std::move(bytes));
    }
}

}  // namespace

Document checkedDocument(GltfSource& source, MemoryBudget& budget, Notes& notes) {
    budget.allowFor(source.fileBytes);
    Document document{source, describe(source.json, budget, notes)};
    readBuffers(document.description, source, budget);
    checkModel(document);
    return document;
}

}  // namespace phat::gltf
