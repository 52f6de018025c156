#include "io/gltf/gltf_images.h"

#include <fmt/core.h>

#include <map>
#include <span>
#include <tuple>

#include "io/gltf/gltf_container.h"
#include "io/gltf/gltf_materials.h"
#include "io/gltf/gltf_picture.h"

namespace phat::gltf {
namespace {

std::string nameOf(const ImageEntry& entry, size_t index) {
    if (!entry.name.empty()) return entry.name;
    if (!entry.uri.empty() && !isDataUri(entry.uri)) return entry.uri;
    return fmt::format("image {}", index);
}

TextureImage loadImage(const Document& document, const ImageEntry& entry, MemoryBudget& budget) {
    if (!entry.uri.empty()) {
        const std::vector<uint8_t> bytes = readUri(entry.uri, gltfFolder(document.source), budget.left());
        budget.allowFor(bytes.size());
        return decodePicture(bytes, budget);
    }
    if (entry.bufferView < 0) throw Problem("has no data");
    const auto& view = document.model().bufferViews[size_t(entry.bufferView)];
    return decodePicture(
        std::span(document.source.buffers[size_t(view.buffer)]).subspan(view.byteOffset, view.byteLength),
        budget);
}

// Where the bytes of a picture are; entries that name the same are one picture.
using PicturePlace = std::tuple<std::string, int32_t, size_t, size_t>;  // URI, or buffer, first byte, length

PicturePlace placeOf(const Document& document, const ImageEntry& entry) {
    if (!entry.uri.empty() || entry.bufferView < 0) return {entry.uri, -1, 0, 0};
    const auto& view = document.model().bufferViews[size_t(entry.bufferView)];
    return {"", view.buffer, view.byteOffset, view.byteLength};
}

}  // namespace

void loadImages(const Document& document, Scene& scene, MemoryBudget& budget, Notes& notes) {
    std::map<PicturePlace, int32_t> sceneImageOf;  // -1: cannot be had
    const auto sceneImage = [&](int32_t index) {
        const ImageEntry& entry = document.description.images[size_t(index)];
        const auto [it, isNew] = sceneImageOf.try_emplace(placeOf(document, entry), -1);
        if (!isNew) return it->second;
        try {
            TextureImage image = loadImage(document, entry, budget);
            image.name = nameOf(entry, size_t(index));
            scene.images.push_back(std::move(image));
            it->second = int32_t(scene.images.size() - 1);
        } catch (const BudgetProblem&) {
            throw;
        } catch (const Problem& problem) {
            notes.lines.push_back(fmt::format("image {} \"{}\" is left white: {}", index,
                                              shortUri(nameOf(entry, size_t(index))), problem.what()));
        }
        return it->second;
    };
    for (Material& material : scene.materials) {
        forEachSlot(material, [&](TextureSlot& slot) {
            if (slot.image < 0) return;
            slot.image = sceneImage(slot.image);
            if (slot.image < 0) slot = {};
        });
    }
}

}  // namespace phat::gltf
