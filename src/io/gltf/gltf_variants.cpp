#include "io/gltf/gltf_variants.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "io/gltf/gltf_json.h"
#include "io/gltf/gltf_plain.h"

namespace phat {
namespace {

using nlohmann::json;

constexpr const char* kVariants = "KHR_materials_variants";

std::vector<std::string> namesIn(const json& file) {
    std::vector<std::string> names;
    const json* extension = gltf::findExtension(file, kVariants);
    if (!extension || !extension->contains("variants") || !extension->at("variants").is_array()) return names;
    for (const json& variant : extension->at("variants"))
        if (variant.is_object()) names.push_back(variant.value("name", ""));
    return names;
}

}  // namespace

std::vector<std::string> gltfVariants(const GltfSource& source) {
    return namesIn(source.json);
}

namespace gltf {

void chooseVariant(json& file, const std::string& variant) {
    if (variant.empty()) return;
    const std::vector<std::string> names = namesIn(file);
    const auto found = std::find(names.begin(), names.end(), variant);
    if (found == names.end())
        throw Problem(names.empty()
                          ? fmt::format("it has no material variants, so none named \"{}\"", variant)
                          : fmt::format("it has no material variant \"{}\"; there are: {}", variant,
                                        fmt::join(names, ", ")));
    const uint64_t chosen = uint64_t(found - names.begin());
    for (size_t m = 0; m < countOf(file, "meshes"); ++m) {
        json& mesh = file["meshes"][m];
        for (size_t p = 0; p < countOf(mesh, "primitives"); ++p) {
            json& primitive = mesh["primitives"][p];
            const json* extension = primitive.is_object() ? findExtension(primitive, kVariants) : nullptr;
            if (!extension || !extension->contains("mappings")) continue;
            const json mappings = extension->at("mappings");
            for (const json& mapping : mappings) {
                const json& variants = mapping.at("variants");
                if (std::find(variants.begin(), variants.end(), json(chosen)) != variants.end())
                    primitive["material"] = wholeNumber(mapping, "material");
            }
        }
    }
}

}  // namespace gltf
}  // namespace phat
