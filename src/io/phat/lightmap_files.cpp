#include "io/phat/lightmap_files.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/base/rgbm.h"
#include "io/gltf/gltf_lightmapped.h"
#include "io/image/image_file.h"
#include "io/phat/bake_record.h"

namespace phat {
namespace {

using nlohmann::json;

constexpr const char* kDescription = "lightmap.json";

// Files of a page, by what lightmap.json calls them.
std::map<std::string, std::string> pageNames(const LightmapExport& what, uint32_t page) {
    const std::string stem = fmt::format("lightmap-{}", page);
    std::map<std::string, std::string> names{{"exr", stem + ".exr"}, {"rgbm", stem + ".png"}};
    if (what.directional) names.insert({{"sh", stem + "-sh.exr"}, {"direction", stem + "-direction.png"}});
    return names;
}

std::string sceneName(const std::string& stem) {
    return stem + ".glb";
}

LightmapFile textFile(const std::string& name, const std::string& text) {
    return {name, {text.begin(), text.end()}};
}

std::vector<uint8_t> rgbmBytes(const Image& irradiance, float range) {
    std::vector<glm::u8vec4> pixels;
    pixels.reserve(irradiance.pixels.size());
    for (const glm::vec3& value : irradiance.pixels) pixels.push_back(encodeRgbm(value, range));
    return pngBytes(irradiance.width, irradiance.height, pixels);
}

// The terms of one page below each other, in the order of Godot's layers.
std::vector<uint8_t> shBytes(const std::array<Image, 4>& terms) {
    constexpr std::array<size_t, 4> kOrder = {0, 2, 3, 1};  // 1, y, z, x
    Image all;
    all.width = terms[0].width;
    all.height = 4 * terms[0].height;
    for (const size_t term : kOrder)
        all.pixels.insert(all.pixels.end(), terms[term].pixels.begin(), terms[term].pixels.end());
    return exrBytes(all, true);
}

// source: Unity's DecodeDirectionalLightmap: light * (n . (rgb - .5) + .5) / a.
std::vector<uint8_t> directionBytes(const std::array<Image, 4>& terms, const Image& irradiance) {
    std::vector<glm::u8vec4> pixels;
    for (size_t i = 0; i < irradiance.pixels.size(); ++i) {
        const float mean = luminance(terms[0].pixels[i]);
        glm::vec4 code(0.5f);
        if (mean > 0) {
            glm::vec3 direction(0);
            for (int axis = 0; axis < 3; ++axis)
                direction[axis] = luminance(terms[size_t(axis) + 1].pixels[i]) / mean;
            // A clamp: what is nearly from one direction is brighter from there than this model has it.
            const float shortened = 1 / std::max(1.0f, glm::length(direction));
            const float towardNormal = luminance(irradiance.pixels[i]) / mean - 1;
            code = 0.5f + 0.5f * shortened * glm::vec4(direction, towardNormal);
        }
        pixels.push_back(glm::u8vec4(glm::round(255.0f * glm::clamp(code, 0.0f, 1.0f))));
    }
    return pngBytes(irradiance.width, irradiance.height, pixels);
}

std::vector<uint8_t> sceneBytes(const LightmapExport& what, std::vector<std::string>& notes) {
    const Scene& scene = what.baked.loaded.scene;
    RewrittenGltf rewritten =
        rewriteGltf(what.source, scene, surfaceParts(scene, what.baked.atlas, what.pages, what.sides));
    notes.insert(notes.end(), rewritten.notes.begin(), rewritten.notes.end());
    gltf::prepareForLightmap(rewritten);
    if (what.light == LightmapLight::all) gltf::dropPunctualLights(rewritten.glb.json);
    return glbBytes(rewritten.glb);
}

void noteCoarseCharts(const AtlasPages& pages, std::vector<std::string>& notes) {
    size_t count = 0;
    for (const AtlasPages::Place& place : pages.place) count += place.coarser > 1;
    if (count > 0)
        notes.push_back(fmt::format(
            "{} charts are larger than a page: their texels are two or four times as wide", count));
}

std::string describe(const LightmapExport& what, float range) {
    json pages = json::array();
    for (uint32_t page = 0; page < what.pages.count; ++page) pages.push_back(pageNames(what, page));
    const json description = {{"generator", "phatextures " PHAT_VERSION},
                              {"scene", sceneName(what.stem)},
                              {"light", nameOf(lightmapLightNames(), what.light)},
                              {"texCoord", 1},
                              {"size", {what.pages.sizeTexels.x, what.pages.sizeTexels.y}},
                              {"rgbmRange", range},
                              {"pages", std::move(pages)}};
    return description.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace

const std::map<std::string, LightmapLight>& lightmapLightNames() {
    static const std::map<std::string, LightmapLight> names = {
        {"indirect", LightmapLight::indirect}, {"area", LightmapLight::area}, {"all", LightmapLight::all}};
    return names;
}

std::vector<std::string> lightmapFileNames(const LightmapExport& what) {
    std::vector<std::string> names{sceneName(what.stem), kDescription};
    for (uint32_t page = 0; page < what.pages.count; ++page)
        for (const auto& [kind, name] : pageNames(what, page)) names.push_back(name);
    return names;
}

std::vector<LightmapFile> lightmapFiles(const LightmapExport& what, Progress& progress,
                                        std::vector<std::string>& notes) {
    const BakedScene& baked = what.baked;
    const Lightmap lightmap = lightmapOf({baked.loaded.scene, baked.atlas, baked.points, baked.phatexture},
                                         what.light, what.directional, progress);
    float largest = 0;
    for (const glm::vec3& value : lightmap.irradiance) largest = std::max(largest, maxComponent(value));
    const float range = rgbmRange(largest);

    std::vector<LightmapFile> files;
    noteCoarseCharts(what.pages, notes);
    files.push_back({sceneName(what.stem), sceneBytes(what, notes)});
    for (uint32_t page = 0; page < what.pages.count; ++page) {
        progress.throwIfStopped();
        const auto pictureOf = [&](const std::vector<glm::vec3>& texels) {
            Image image;
            image.width = int(what.pages.sizeTexels.x);
            image.height = int(what.pages.sizeTexels.y);
            image.pixels = texelsOfPage(texels, baked.atlas, what.pages, page);
            return image;
        };
        const Image irradiance = pictureOf(lightmap.irradiance);
        const auto names = pageNames(what, page);
        files.push_back({names.at("exr"), exrBytes(irradiance, true)});
        files.push_back({names.at("rgbm"), rgbmBytes(irradiance, range)});
        if (!lightmap.byNormal) continue;
        std::array<Image, 4> terms;
        for (size_t t = 0; t < terms.size(); ++t) terms[t] = pictureOf(lightmap.byNormal->term[t]);
        files.push_back({names.at("sh"), shBytes(terms)});
        files.push_back({names.at("direction"), directionBytes(terms, irradiance)});
    }
    files.push_back(textFile(kDescription, describe(what, range)));
    return files;
}

}  // namespace phat
