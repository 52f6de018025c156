// phat render: one picture of a baked file.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/bake_stages.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/material_edit.h"
#include "cli/progress_bar.h"
#include "core/irradiance.h"
#include "gl/gl_context.h"
#include "gl/renderer.h"
#include "io/atomic_file.h"
#include "io/baked_file.h"
#include "io/file_error.h"
#include "io/image_file.h"

namespace phat {
namespace {

using nlohmann::json;

const std::map<std::string, Component> kComponents = {{"all", Component::all},
                                                      {"direct", Component::direct},
                                                      {"indirect", Component::indirect},
                                                      {"glossy-indirect", Component::glossyIndirect},
                                                      {"diffuse-indirect", Component::diffuseIndirect}};
const std::map<std::string, ToneMap> kToneMaps = {
    {"linear", ToneMap::linear}, {"agx", ToneMap::agx}, {"aces", ToneMap::aces}};
const std::vector<std::string> kMethods = {"phat", "phat-pyramid"};

constexpr int kMaxPictureSide = 16384;

struct RenderOptions {
    std::string input;
    std::string output;
    std::string camera;  // name or index; empty: the first
    std::optional<glm::vec3> eye, target;
    std::optional<float> fovDegrees;
    int width = 960;
    int height = 0;  // 0: from the camera's aspect
    int samplesPerPixel = 4;
    Component component = Component::all;
    std::vector<std::string> edits;
    float exposureStops = 0;
    ToneMap toneMap = ToneMap::agx;
    bool quiet = false;
    bool json = false;
};

glm::vec3 parsePoint(const CLI::Option* option) {
    const auto text = option->as<std::string>();
    glm::vec3 p(0);
    char end = 0;
    if (std::sscanf(text.c_str(), "%f,%f,%f%c", &p.x, &p.y, &p.z, &end) != 3 ||
        !std::isfinite(p.x + p.y + p.z))
        throw CLI::ValidationError(option->get_name(), fmt::format("\"{}\" is not x,y,z", text));
    return p;
}

void parseSize(const CLI::Option* option, RenderOptions& options) {
    const auto text = option->as<std::string>();
    char end = 0;
    if (std::sscanf(text.c_str(), "%dx%d%c", &options.width, &options.height, &end) != 2 ||
        options.width < 1 || options.height < 1 || options.width > kMaxPictureSide ||
        options.height > kMaxPictureSide)
        throw CLI::ValidationError(
            option->get_name(), fmt::format("\"{}\" is not WxH, each from 1 to {}", text, kMaxPictureSide));
}

std::string pictureKind(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    for (char& c : extension) c = char(std::tolower(uint8_t(c)));
    if (extension != ".exr" && extension != ".png")
        throw CLI::ValidationError("--output", fmt::format("\"{}\" is neither .exr nor .png", path));
    return extension;
}

std::filesystem::path shaderFolder() {
    // Installed beside the program, or where it was built.
    std::error_code ignored;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
    const auto installed = program.parent_path().parent_path() / "share/phatextures/shaders";
    return std::filesystem::is_directory(installed, ignored) ? installed
                                                             : std::filesystem::path(PHAT_SHADER_DIR);
}

const Camera& cameraNamed(const RenderOptions& options, const std::vector<Camera>& cameras) {
    std::vector<std::string> names;
    for (const Camera& camera : cameras) {
        if (camera.name == options.camera) return camera;
        names.push_back(camera.name);
    }
    char* end = nullptr;
    const unsigned long index = std::strtoul(options.camera.c_str(), &end, 10);
    if (end != options.camera.c_str() && *end == 0 && index < cameras.size()) return cameras[index];
    throw CLI::ValidationError("--camera", fmt::format("there is no camera \"{}\"; there are: {}",
                                                       options.camera, fmt::join(names, ", ")));
}

Camera chooseCamera(const RenderOptions& options, const Scene& scene) {
    Camera camera = scene.cameras.empty() ? defaultCamera(scene) : scene.cameras.front();
    if (!options.camera.empty()) camera = cameraNamed(options, scene.cameras);
    if (options.fovDegrees) {
        camera.perspective = true;
        camera.yfovRadians = glm::radians(*options.fovDegrees);
    }
    if (!options.eye && !options.target) return camera;

    const glm::vec3 eye = options.eye.value_or(glm::vec3(camera.worldFromCamera[3]));
    const glm::vec3 target = options.target.value_or(boundsOf(scene).center());
    const glm::vec3 forward = target - eye;
    if (!(glm::length(forward) > 0)) throw CLI::ValidationError("--target", "is where the eye is");
    const bool vertical = glm::length(glm::cross(glm::normalize(forward), glm::vec3(0, 1, 0))) < 1e-3f;
    camera.worldFromCamera =
        glm::inverse(glm::lookAt(eye, target, vertical ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0)));
    camera.aspect = 0;
    return camera;
}

// A scene that is not baked yet is baked as `phat bake` would without flags.
BakedScene loadBaked(const RenderOptions& options, Progress& progress) {
    if (isBakedFile(options.input)) return readBakedFile(options.input);
    BakedScene baked;
    baked.loaded = loadGltf(options.input);
    if (baked.loaded.scene.triangles.empty()) throw FileError(options.input, "has no triangles to bake");
    Bake result = bake(baked.loaded.scene, BakeSettings(), progress);
    baked.atlas = std::move(result.atlas);
    baked.points = std::move(result.points);
    baked.phatexture = std::move(result.phatexture);
    return baked;
}

void runRender(const RenderOptions& options) {
    const std::string kind = pictureKind(options.output);
    checkReplaceable(options.output);
    catchInterrupts();
    std::optional<ProgressBar> progress(std::in_place, progressStyle(options.quiet),
                                        bakeStages(BakeSettings()));
    BakedScene baked = loadBaked(options, *progress);
    Scene& scene = baked.loaded.scene;
    try {
        for (const std::string& edit : options.edits) editMaterial(edit, scene.materials);
    } catch (const std::invalid_argument& error) {
        throw CLI::ValidationError("--set", error.what());
    }

    FrameSettings frame;
    frame.camera = chooseCamera(options, scene);
    frame.component = options.component;
    frame.samplesPerPixel = options.samplesPerPixel;
    frame.width = options.width;
    const float aspect = frame.camera.aspect > 0 ? frame.camera.aspect : 16.0f / 9;
    frame.height = options.height > 0
                       ? options.height
                       : std::clamp(int(std::lround(float(options.width) / aspect)), 1, kMaxPictureSide);

    const IrradianceMap irradiance =
        filterIndirectIrradiance(baked.phatexture, baked.atlas, baked.points, *progress);
    const HeadlessContext context;
    Renderer renderer({scene, baked.atlas, baked.points, baked.phatexture, irradiance},
                      shaderFolder().string());
    progress->throwIfStopped();
    const Image picture = renderer.render(frame);
    progress->throwIfStopped();
    if (kind == ".exr")
        writeExr(options.output, picture);
    else
        writePng(options.output, toneMap(picture, options.toneMap, options.exposureStops));

    progress.reset();
    const FrameTimes times = renderer.lastFrameTimes();
    if (options.json) {
        const json stats = {{"output", options.output},
                            {"width", frame.width},
                            {"height", frame.height},
                            {"gpu", context.rendererName()},
                            {"seconds",
                             {{"relight", times.relight},
                              {"pyramid", times.pyramid},
                              {"shadows", times.shadows},
                              {"display", times.display}}}};
        fmt::print("{}\n", stats.dump(-1, ' ', false, json::error_handler_t::replace));
    } else if (!options.quiet) {
        fmt::print(
            "{}: {} x {}, relight {:.1f} ms, pyramid {:.1f} ms, shadows {:.1f} ms, display {:.1f} ms\n",
            options.output, frame.width, frame.height, times.relight * 1e3, times.pyramid * 1e3,
            times.shadows * 1e3, times.display * 1e3);
    }
}

}  // namespace

void addRenderCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("render", "Draw a picture of a baked file");
    const auto option = [&](const char* name, const char* type, const std::string& help) {
        return command->add_option(name, help)->type_name(type);
    };
    CLI::Option* input = option("IN", "FILE", "A baked file; a scene is baked first")->required();
    CLI::Option* output = option("-o,--output", "FILE", "The picture: .exr (linear) or .png")->required();
    CLI::Option* method = option("--method", "NAME", "phat or phat-pyramid")->check(CLI::IsMember(kMethods));
    CLI::Option* camera = option("--camera", "NAME", "Name or index; default: the file's first");
    CLI::Option* eye = option("--eye", "X,Y,Z", "Where the eye is");
    CLI::Option* target = option("--target", "X,Y,Z", "What it looks at");
    CLI::Option* fov = option("--fov", "DEGREES", "Vertical field of view")->check(CLI::Range(0.1, 179.0));
    CLI::Option* size = option("--size", "WxH", "Default: 960 wide, the height from the camera");
    CLI::Option* spp = option("--spp", "N", "Anti-aliasing: pictures to average")
                           ->check(CLI::Range(1, 4096))
                           ->default_val(FrameSettings().samplesPerPixel);
    CLI::Option* component =
        option("--component", "NAME", "all, direct, indirect, glossy-indirect or diffuse-indirect")
            ->check(CLI::IsMember(kComponents))
            ->default_val("all");
    CLI::Option* edits =
        option("--set", "MATERIAL.PROPERTY=VALUE", "Changes a material, e.g. floor.roughness=0.3")
            ->expected(1, -1);
    CLI::Option* exposure =
        option("--exposure", "EV", "Stops, for .png")->check(CLI::Range(-40.0, 40.0))->default_val("0");
    CLI::Option* toneMapping = option("--tonemap", "NAME", "linear, agx or aces, for .png")
                                   ->check(CLI::IsMember(kToneMaps))
                                   ->default_val("agx");
    CLI::Option* quiet = command->add_flag("--quiet")->description("Print errors only");
    CLI::Option* asJson = command->add_flag("--json")->description("Print sizes and times as JSON");
    command->footer("Example: phat render room.phat.glb -o room.png --set floor.roughness=0.2 --exposure 1");
    command->callback([=] {
        (void)method;  // both names are the same renderer
        RenderOptions options;
        options.input = input->as<std::string>();
        options.output = output->as<std::string>();
        if (*camera) options.camera = camera->as<std::string>();
        if (*eye) options.eye = parsePoint(eye);
        if (*target) options.target = parsePoint(target);
        if (*fov) options.fovDegrees = fov->as<float>();
        if (*size) parseSize(size, options);
        options.samplesPerPixel = spp->as<int>();
        options.component = kComponents.at(component->as<std::string>());
        if (*edits) options.edits = edits->results();
        options.exposureStops = exposure->as<float>();
        options.toneMap = kToneMaps.at(toneMapping->as<std::string>());
        options.quiet = quiet->count() > 0;
        options.json = asJson->count() > 0;
        runRender(options);
    });
}

}  // namespace phat
