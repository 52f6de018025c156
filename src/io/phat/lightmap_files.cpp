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

std::string exrName(uint32_t page) {
    return fmt::format("lightmap-{}.exr", page);
}

std::string rgbmName(uint32_t page) {
    return fmt::format("lightmap-{}.png", page);
}

std::string sceneName(const std::string& stem) {
    return stem + ".glb";
}

LightmapFile textFile(const std::string& name, const std::string& text) {
    return {name, {text.begin(), text.end()}};
}

LightmapFile rgbmFile(uint32_t page, const Image& irradiance, float range) {
    std::vector<glm::u8vec4> pixels;
    pixels.reserve(irradiance.pixels.size());
    for (const glm::vec3& value : irradiance.pixels) pixels.push_back(encodeRgbm(value, range));
    return {rgbmName(page), pngBytes(irradiance.width, irradiance.height, pixels)};
}

std::vector<uint8_t> sceneBytes(const LightmapExport& what, std::vector<std::string>& notes) {
    const Scene& scene = what.baked.loaded.scene;
    RewrittenGltf rewritten =
        rewriteGltf(what.source, scene, surfaceParts(scene, what.baked.atlas, what.pages));
    notes.insert(notes.end(), rewritten.notes.begin(), rewritten.notes.end());
    gltf::prepareForLightmap(rewritten);
    if (what.light == LightmapLight::all) gltf::dropPunctualLights(rewritten.glb.json);
    return glbBytes(rewritten.glb);
}

std::string describe(const LightmapExport& what, float range) {
    json pages = json::array();
    for (uint32_t page = 0; page < what.pages.count; ++page)
        pages.push_back({{"exr", exrName(page)}, {"rgbm", rgbmName(page)}});
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

std::vector<std::string> lightmapFileNames(const std::string& stem, const AtlasPages& pages) {
    std::vector<std::string> names{sceneName(stem), kDescription};
    for (uint32_t page = 0; page < pages.count; ++page) {
        names.push_back(exrName(page));
        names.push_back(rgbmName(page));
    }
    return names;
}

std::vector<LightmapFile> lightmapFiles(const LightmapExport& what, Progress& progress,
                                        std::vector<std::string>& notes) {
    const BakedScene& baked = what.baked;
    const RayScene rays(baked.loaded.scene);
    const LightSampler lights(baked.loaded.scene);
    const std::vector<glm::vec3> irradiance =
        lightmapOf({rays, lights}, baked.atlas, baked.points, baked.phatexture, what.light, progress);
    float largest = 0;
    for (const glm::vec3& value : irradiance) largest = std::max(largest, maxComponent(value));
    const float range = rgbmRange(largest);

    std::vector<LightmapFile> files;
    files.push_back({sceneName(what.stem), sceneBytes(what, notes)});
    for (uint32_t page = 0; page < what.pages.count; ++page) {
        progress.throwIfStopped();
        Image image;
        image.width = int(what.pages.sizeTexels.x);
        image.height = int(what.pages.sizeTexels.y);
        image.pixels = texelsOfPage(irradiance, baked.atlas, what.pages, page);
        files.push_back({exrName(page), exrBytes(image, true)});
        files.push_back(rgbmFile(page, image, range));
    }
    files.push_back(textFile(kDescription, describe(what, range)));
    return files;
}

}  // namespace phat
