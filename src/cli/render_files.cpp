#include "cli/render_files.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

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

Scene loadScene(const RenderOptions& options) {
    // A baked file holds the environment that it was baked in.
    GltfSource source = openGltf(options.input);
    const bool baked = isBakedFile(source);
    if (baked) refuseVariant(options);
    Scene scene = baked ? std::move(readBakedFile(source).loaded.scene)
                        : std::move(loadGltf(source, {options.variant}).scene);
    if (!options.environment.empty()) scene.environment = loadEnvironment(options.environment);
    if (!options.keepLight) editScene(options, scene);
    return scene;
}

BakedScene loadBaked(const RenderOptions& options, Progress& progress) {
    GltfSource source = openGltf(options.input);
    if (!options.environment.empty() && isBakedFile(source))
        throw CLI::ValidationError("--environment", "the bake has its own; bake again to change it");
    if (isBakedFile(source)) refuseVariant(options);
    BakedScene baked = readSceneFile(source, options.environment, {options.variant});
    if (baked.phatexture.indirect.empty()) {
        Bake result = bake(baked.loaded.scene, BakeSettings(), progress);
        baked.atlas = std::move(result.atlas);
        baked.points = std::move(result.points);
        baked.phatexture = std::move(result.phatexture);
    }
    editScene(options, baked.loaded.scene);
    return baked;
}

void editScene(const RenderOptions& options, Scene& scene) {
    try {
        for (const std::string& edit : options.edits) editMaterial(edit, scene.materials);
    } catch (const std::invalid_argument& error) {
        throw CLI::ValidationError("--set", error.what());
    }
}

void writePicture(const RenderOptions& options, const View& view, const Image& picture) {
    const std::string path = pathFor(view, options.output);
    const std::string kind = pictureKind(path);
    if (kind == ".exr")
        writeExr(path, picture);
    else
        (kind == ".png" ? writePng : writeJpeg)(path,
                                                toneMap(picture, options.toneMap, options.exposureStops));
}

}  // namespace phat
