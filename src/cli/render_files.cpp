#include "cli/render_files.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/lighting_options.h"
#include "core/bake/bake.h"
#include "io/base/atomic_file.h"
#include "io/gltf/gltf_source.h"
#include "io/gltf/material_edit.h"
#include "io/image/image_file.h"
#include "io/phat/scene_file.h"

namespace phat {
namespace {

std::string pictureKind(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    for (char& c : extension) c = char(std::tolower(uint8_t(c)));
    return extension == ".jpeg" ? ".jpg" : extension;
}

void refuseVariant(const RenderOptions& options) {
    if (!options.variant.empty())
        throw CLI::ValidationError("--variant", "the bake is of one variant; bake the scene again");
}

}  // namespace

void checkPlaces(const RenderOptions& options) {
    const std::string kind = pictureKind(options.output);
    if (kind != ".exr" && kind != ".png" && kind != ".jpg")
        throw CLI::ValidationError("--output",
                                   fmt::format("\"{}\" is neither .exr, .png nor .jpg", options.output));
    if (!options.varianceOutput.empty()) {
        if (pictureKind(options.varianceOutput) != ".exr")
            throw CLI::ValidationError("--variance",
                                       fmt::format("\"{}\" is not .exr", options.varianceOutput));
        const auto full = [](const std::string& path) {
            return std::filesystem::absolute(path).lexically_normal();
        };
        if (full(options.varianceOutput) == full(options.output))
            throw CLI::ValidationError("--variance", "is the picture's own file");
        checkReplaceable(options.varianceOutput);
    }
    checkReplaceable(options.output);
}

namespace {

// A wrong name must not cost a bake.
void checkAgainst(const RenderOptions& options, const Scene& scene) {
    chooseViews(options, scene);
    if (options.animated) animationOf(options, scene);
    Scene edited;
    edited.materials = scene.materials;
    editScene(options, edited);
}

}  // namespace

const Animation& animationOf(const RenderOptions& options, const Scene& scene) {
    if (scene.animations.empty())
        throw CLI::ValidationError("--animate", "the file has no animation that moves a node");
    const std::string& wanted = options.animated->animation;
    if (wanted.empty()) return scene.animations.front();
    for (const Animation& animation : scene.animations)
        if (animation.name == wanted) return animation;
    char* end = nullptr;
    const unsigned long index = std::strtoul(wanted.c_str(), &end, 10);
    if (*end == 0 && index < scene.animations.size()) return scene.animations[index];
    throw CLI::ValidationError("--animation", fmt::format("there is no animation \"{}\"", wanted));
}

void reportNotes(const SceneFile& file, nlohmann::json& report) {
    if (!file.added.lines.empty()) report["notes"] = file.added.lines;
}

SceneFile loadScene(const RenderOptions& options) {
    GltfSource source = openGltf(options.input);
    if (isBakedFile(source)) refuseVariant(options);
    SceneFile file = readSceneFile(source, options.lighting, BakedLighting::replace, {options.variant});
    if (!options.quiet) printLines(options.input, file.added.lines);
    checkAgainst(options, file.baked.loaded.scene);
    if (!options.keepLight) editScene(options, file.baked.loaded.scene);
    return file;
}

SceneFile loadBaked(const RenderOptions& options, Progress& progress) {
    GltfSource source = openGltf(options.input);
    if (options.lighting.asked() && isBakedFile(source))
        throw CLI::ValidationError(options.lighting.environment.empty() ? "--sky" : "--environment",
                                   "the bake has its own light; bake again to change it");
    if (isBakedFile(source)) refuseVariant(options);
    SceneFile file = readSceneFile(source, options.lighting, BakedLighting::refuse, {options.variant});
    BakedScene& baked = file.baked;
    if (!options.quiet) printLines(options.input, file.added.lines);
    checkAgainst(options, baked.loaded.scene);
    if (baked.phatexture.indirect.empty()) {
        Bake result = bake(raysOf(baked.loaded.scene, file.added), BakeSettings(), progress);
        baked.atlas = std::move(result.atlas);
        baked.points = std::move(result.points);
        baked.phatexture = std::move(result.phatexture);
    }
    editScene(options, baked.loaded.scene);
    return file;
}

void editScene(const RenderOptions& options, Scene& scene) {
    try {
        for (const std::string& edit : options.edits) editMaterial(edit, scene.materials);
    } catch (const std::invalid_argument& error) {
        throw CLI::ValidationError("--set", error.what());
    }
}

bool isLinear(const std::string& path) {
    return pictureKind(path) == ".exr";
}

void writePicture(const RenderOptions& options, const View& view, const Image& picture, float exposureStops) {
    const std::string path = pathFor(view, options.output);
    const std::string kind = pictureKind(path);
    if (kind == ".exr")
        writeExr(path, picture);
    else
        (kind == ".png" ? writePng : writeJpeg)(path, toneMap(picture, options.toneMap, exposureStops));
}

}  // namespace phat
