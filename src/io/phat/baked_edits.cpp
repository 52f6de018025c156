#include "io/phat/baked_edits.h"

#include <algorithm>
#include <cmath>

#include "io/base/atomic_file.h"
#include "io/base/file_error.h"
#include "io/gltf/glb_builder.h"
#include "io/gltf/gltf_json.h"
#include "io/gltf/gltf_light_profiles.h"
#include "io/gltf/gltf_rewrite.h"
#include "io/gltf/gltf_source.h"
#include "io/phat/phat_payload.h"

namespace phat {
namespace {

using nlohmann::json;

constexpr const char* kLights = "KHR_lights_punctual";

json arrayOf(glm::vec3 v) {
    return {v.x, v.y, v.z};
}

void useExtension(json& gltf, const char* name) {
    json& used = gltf["extensionsUsed"];
    if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
}

// Radiance of 1 at most is a factor, the rest a strength: KHR_materials_emissive_strength.
void writeEmission(json& gltf, json& out, glm::vec3 emission) {
    const float strength = std::max({1.0f, emission.x, emission.y, emission.z});
    out["emissiveFactor"] = arrayOf(emission / strength);
    if (strength == 1 && !out["extensions"].contains("KHR_materials_emissive_strength")) return;
    out["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
    useExtension(gltf, "KHR_materials_emissive_strength");
}

// What did not change stays as the file says it, to the letter.
void writeMaterial(json& gltf, json& out, const Material& from, const Material& to) {
    json& pbr = out["pbrMetallicRoughness"];
    if (from.baseColor != to.baseColor)
        pbr["baseColorFactor"] = {to.baseColor.r, to.baseColor.g, to.baseColor.b, to.baseColor.a};
    if (from.metallic != to.metallic) pbr["metallicFactor"] = to.metallic;
    if (from.roughness != to.roughness) pbr["roughnessFactor"] = to.roughness;
    if (pbr.is_null()) out.erase("pbrMetallicRoughness");
    if (from.normalScale != to.normalScale && out.contains("normalTexture"))
        out["normalTexture"]["scale"] = to.normalScale;
    const auto extension = [&](const char* name, const char* key, const json& value) {
        out["extensions"][name][key] = value;
        useExtension(gltf, name);
    };
    if (from.specular != to.specular) extension("KHR_materials_specular", "specularFactor", to.specular);
    if (from.specularColor != to.specularColor)
        extension("KHR_materials_specular", "specularColorFactor", arrayOf(to.specularColor));
    if (from.ior != to.ior) extension("KHR_materials_ior", "ior", to.ior);
    if (from.clearcoat != to.clearcoat) extension("KHR_materials_clearcoat", "clearcoatFactor", to.clearcoat);
    if (from.clearcoatRoughness != to.clearcoatRoughness)
        extension("KHR_materials_clearcoat", "clearcoatRoughnessFactor", to.clearcoatRoughness);
    if (from.transmission != to.transmission)
        extension("KHR_materials_transmission", "transmissionFactor", to.transmission);
    if (from.thickness != to.thickness) extension("KHR_materials_volume", "thicknessFactor", to.thickness);
    if (from.attenuationDistance != to.attenuationDistance) {
        // Without the key it is infinite, for which JSON has no number.
        if (std::isfinite(to.attenuationDistance))
            extension("KHR_materials_volume", "attenuationDistance", to.attenuationDistance);
        else
            out["extensions"]["KHR_materials_volume"].erase("attenuationDistance");
    }
    if (from.attenuationColor != to.attenuationColor)
        extension("KHR_materials_volume", "attenuationColor", arrayOf(to.attenuationColor));
    if (from.emission != to.emission) writeEmission(gltf, out, to.emission);
    if (out.contains("extensions") && out["extensions"].empty()) out.erase("extensions");
}

// A definition that other nodes use as well is left to them.
void writeLight(json& gltf, const PunctualLight& light) {
    json& node = gltf["nodes"][light.node];
    if (light.photometry) return gltf::writeProfileIntensity(node, light);
    json& definitions = gltf["extensions"][kLights]["lights"];
    json changed = definitions.at(node["extensions"][kLights]["light"].get<size_t>());
    const float intensity = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
    changed["intensity"] = intensity;
    changed["color"] = arrayOf(intensity > 0 ? light.intensity / intensity : glm::vec3(1));
    node["extensions"][kLights]["light"] = definitions.size();
    definitions.push_back(std::move(changed));
}

// Definitions that no node uses any more are taken out.
void dropUnusedLights(json& gltf) {
    if (!gltf::findExtension(gltf, kLights)) return;
    json kept = json::array();
    json& definitions = gltf["extensions"][kLights]["lights"];
    std::vector<int64_t> newIndex(definitions.size(), -1);
    for (json& node : gltf["nodes"]) {
        if (!node.contains("extensions") || !node["extensions"].contains(kLights)) continue;
        json& index = node["extensions"][kLights]["light"];
        const size_t old = index.get<size_t>();
        if (newIndex.at(old) < 0) {
            newIndex[old] = int64_t(kept.size());
            kept.push_back(definitions[old]);
        }
        index = newIndex[old];
    }
    definitions = std::move(kept);
}

// The file's own values, moved: nothing is rounded.
void turnEnvironment(GlbBuilder& glb, int columns) {
    const json& sky = glb.json.at("extensions").at(kPhatExtension).at("environment");
    const size_t width = sky.at("size").at(0).get<size_t>(), height = sky.at("size").at(1).get<size_t>();
    const json& payload = sky.at("radiance");
    const size_t view = payload.at("bufferView").get<size_t>();
    const json& bufferView = glb.json.at("bufferViews").at(view);
    const std::span<const uint8_t> stream = std::span(glb.bin).subspan(
        bufferView.value("byteOffset", size_t(0)), bufferView.at("byteLength").get<size_t>());
    std::vector<uint8_t> bytes = decodePayload(stream, payload.at("byteLength").get<size_t>());
    const size_t row = width * sizeof(uint32_t);
    const size_t shift = size_t(((columns % int(width)) + int(width)) % int(width)) * sizeof(uint32_t);
    for (size_t y = 0; y < height; ++y) {
        const auto begin = bytes.begin() + ptrdiff_t(y * row);
        std::rotate(begin, begin + ptrdiff_t((row - shift) % row), begin + ptrdiff_t(row));
    }
    replaceBufferView(glb, view, encodePayload(bytes));
}

}  // namespace

void writeEdits(const std::string& path, const std::string& outPath, const SceneEdits& from,
                const SceneEdits& to) {
    std::vector<uint8_t> bytes;
    try {
        GltfSource source = openGltf(path);
        readGltfBuffers(source);
        if (source.buffers.size() != 1) throw std::runtime_error("is not a file of one binary buffer");
        GlbBuilder glb{std::move(source.json), std::move(source.buffers[0])};
        glb.json.erase("buffers");
        for (size_t i = 0; i < to.materials.size(); ++i)
            // The loader's own material for primitives without one is not in the file.
            if (glb.json.contains("materials") && i < glb.json["materials"].size())
                writeMaterial(glb.json, glb.json["materials"][i], from.materials.at(i), to.materials[i]);
        bool anyLight = false;
        for (size_t i = 0; i < to.lights.size(); ++i) {
            if (to.lights[i].intensity == from.lights.at(i).intensity) continue;
            writeLight(glb.json, to.lights[i]);
            anyLight = true;
        }
        if (anyLight) dropUnusedLights(glb.json);
        if (from.environmentColumns != to.environmentColumns)
            turnEnvironment(glb, to.environmentColumns - from.environmentColumns);
        bytes = glbBytes(glb);
    } catch (const FileError&) {
        throw;
    } catch (const std::exception& error) {
        throw FileError(path, error.what());
    }
    replaceFile(outPath, bytes);
}

}  // namespace phat
