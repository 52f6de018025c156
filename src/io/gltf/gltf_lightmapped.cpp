#include "io/gltf/gltf_lightmapped.h"

#include <fmt/format.h>

#include <map>
#include <tuple>

#include "io/gltf/gltf_json.h"

namespace phat::gltf {
namespace {

using nlohmann::json;

constexpr const char* kLights = "KHR_lights_punctual";

std::string texCoordName(uint64_t set) {
    return fmt::format("TEXCOORD_{}", set);
}

// Sets that the file had from 1 on. `texCoord`: of the atlas.
void moveSetsUp(json& attributes, uint32_t texCoord) {
    json atlasSet;
    if (attributes.contains(texCoordName(texCoord))) atlasSet = attributes[texCoordName(texCoord)];
    bool moved = false;
    for (uint32_t set = texCoord; set-- > 1;) {
        if (!attributes.contains(texCoordName(set))) continue;
        attributes[texCoordName(set + 1)] = attributes[texCoordName(set)];
        attributes.erase(texCoordName(set));
        moved = true;
    }
    // What is no surface, such as lines, has no place in the atlas, but sets are numbered without gaps.
    if (atlasSet.is_null() && moved) atlasSet = attributes.at(texCoordName(0));
    if (!atlasSet.is_null()) attributes[texCoordName(1)] = atlasSet;
}

// Wherever in a material a texture says which set it takes.
void nameMovedSets(json& value, uint32_t texCoord) {
    if (!value.is_structured()) return;
    for (auto it = value.begin(); it != value.end(); ++it) {
        if (value.is_object() && it.key() == "extras") continue;
        if (value.is_object() && it.key() == "texCoord") {
            const uint64_t set = wholeNumber(value, "texCoord");
            if (set >= 1 && set < texCoord) *it = set + 1;
        } else {
            nameMovedSets(*it, texCoord);
        }
    }
}

void makeAtlasTheSecondSet(json& gltf, uint32_t texCoord) {
    if (texCoord == 1 || !gltf.contains("meshes")) return;
    for (json& mesh : gltf["meshes"])
        for (json& primitive : mesh.at("primitives")) moveSetsUp(primitive.at("attributes"), texCoord);
    if (!gltf.contains("materials")) return;
    for (json& material : gltf["materials"]) nameMovedSets(material, texCoord);
}

/// The materials of surfaces by what else they depend on there.
class PageMaterials {
  public:
    explicit PageMaterials(json& gltf) : gltf_(gltf) {}

    // The material of `part` in place of `object`'s. None is the default material.
    void replaceIn(json& object, const RewrittenPart& part) {
        const int64_t original =
            object.contains("material") ? int64_t(wholeNumber(object, "material")) : kDefault;
        object["material"] = materialOf(original, part);
    }

  private:
    static constexpr int64_t kDefault = -1;
    using Key = std::tuple<int64_t, uint32_t, bool>;

    size_t materialOf(int64_t original, const RewrittenPart& part) {
        const auto [found, isNew] = made_.try_emplace(Key(original, part.page, part.oneSided), 0);
        if (!isNew) return found->second;
        json& materials = gltf_["materials"];
        if (original != kDefault && originals_.try_emplace(original, materials.at(size_t(original))).second) {
            found->second = size_t(original);
        } else {
            materials.push_back(original == kDefault ? json::object() : originals_.at(original));
            found->second = materials.size() - 1;
        }
        json& material = materials[found->second];
        if (part.oneSided) material.erase("doubleSided");
        // An unlit surface shows its colour, whatever light falls on it.
        if (findExtension(material, "KHR_materials_unlit")) return found->second;
        if (!material.contains("extras") || !material["extras"].is_object())
            material["extras"] = json::object();
        material["extras"]["lightmap"] = part.page;
        return found->second;
    }

    json& gltf_;
    std::map<Key, size_t> made_;
    std::map<int64_t, json> originals_;  // as they were
};

}  // namespace

void prepareForLightmap(RewrittenGltf& rewritten) {
    json& gltf = rewritten.glb.json;
    makeAtlasTheSecondSet(gltf, rewritten.texCoord);
    rewritten.texCoord = 1;
    PageMaterials materials(gltf);
    for (const RewrittenPart& part : rewritten.parts) {
        json& primitive = gltf["meshes"].at(part.mesh).at("primitives").at(part.primitive);
        materials.replaceIn(primitive, part);
        const json::json_pointer mappings("/extensions/KHR_materials_variants/mappings");
        if (primitive.contains(mappings))
            for (json& mapping : primitive[mappings]) materials.replaceIn(mapping, part);
    }
}

void dropPunctualLights(json& gltf) {
    if (gltf.contains("nodes"))
        for (json& node : gltf["nodes"]) eraseExtension(node, kLights);
    eraseExtension(gltf, kLights);
    forgetExtension(gltf, kLights);
}

}  // namespace phat::gltf
