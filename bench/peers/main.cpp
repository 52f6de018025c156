// phat_peers: what PHATextures are compared with, and the small pictures that tools/figures.py needs.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "core/base/stopwatch.h"
#include "core/scene/lights.h"
#include "gaussian_lightmap.h"
#include "gl/renderer.h"
#include "gl/shader_loader.h"
#include "io/base/file_error.h"
#include "io/image/image_file.h"
#include "io/phat/baked_file.h"
#include "peer_picture.h"
#include "reflection_probe.h"

namespace phat::peers {
namespace {

using nlohmann::json;

struct Options {
    std::string input, output, material, peer;
    int width = 480, height = 270;
    int samplesPerPixel = 4;
    std::vector<float> roughness;
    std::vector<float> place;  // the probe's; empty: the middle of the scene
    std::string reading = "warped";
    int raysPerTexel = GaussianSettings().raysPerTexel;
    float exposureStops = 0;
    int shrink = 1;
    int zoom = 1;
    std::vector<float> eye, target;  // empty: the file's camera
    uint32_t count = 0;
    std::vector<int> window;  // x y width height; empty: all
    std::string mask;
    bool center = false;
    std::vector<std::string> defines;
};

/// PHATexels on the surface of one material: what a peer may use as many bytes as.
uint64_t phatexelBytes(const BakedScene& baked, uint32_t material) {
    uint64_t count = 0;
    for (size_t texel = 0; texel < baked.points.state.size(); ++texel)
        if (baked.points.state[texel] == TexelState::surface &&
            materialAt(baked.loaded.scene, baked.points.triangle[texel]) == material)
            ++count;
    return count * baked.phatexture.indirect.size() * sizeof(PackedPhatexel);
}

/// Side of their texels, in metres.
float phatexelSize(const BakedScene& baked, uint32_t material) {
    float finest = baked.atlas.texelSizeMeters;
    for (const Chart& chart : baked.atlas.charts)
        if (baked.loaded.scene.surfaces[chart.surface].material == material)
            finest = std::min(finest, chart.texelSizeMeters);
    return finest;
}

const Camera& firstCamera(const Scene& scene, const std::string& path) {
    if (scene.cameras.empty()) throw FileError(path, "has no camera");
    return scene.cameras.front();
}

void writeViews(const Options& options, const RayScene& rays, uint32_t material, const Shade& shade,
                json& report) {
    SilentProgress progress;
    std::vector<float> all = options.roughness;
    if (all.empty()) all.push_back(rays.scene().materials[material].roughness);
    for (const float roughness : all) {
        Scene edited = rays.scene();
        edited.materials[material].roughness = roughness;
        PictureSettings settings;
        settings.width = options.width;
        settings.height = options.height;
        settings.camera = firstCamera(edited, options.input);
        settings.samplesPerPixel = options.samplesPerPixel;
        if (options.center) settings.filter = PixelFilter::center;
        const Stopwatch start;
        const TracedPicture picture =
            tracePicture(settings, peerIntegrator(rays, edited, material, shade), progress);
        const std::string path =
            all.size() == 1 ? options.output : fmt::format(fmt::runtime(options.output), roughness);
        writeExr(path, picture.mean);
        report["pictures"].push_back(
            {{"output", path}, {"roughness", roughness}, {"seconds", start.seconds()}});
    }
}

void renderPeer(const Options& options) {
    const BakedScene baked = readBakedFile(options.input);
    const Scene& scene = baked.loaded.scene;
    const uint32_t material = materialNamed(scene, options.material);
    const RayScene rays(scene);
    const LightSampler lights(scene);
    SilentProgress progress;
    const uint64_t allowed = phatexelBytes(baked, material);
    json report{{"peer", options.peer}, {"phatexelBytes", allowed}};
    const Stopwatch start;
    if (options.peer == "probe") {
        ProbeSettings settings;
        settings.box = boundsOf(scene);
        settings.position = options.place.empty()
                                ? settings.box.center()
                                : glm::vec3(options.place[0], options.place[1], options.place[2]);
        settings.faceSize = probeFaceSize(allowed);
        settings.paths.pathsPerHit = BakeSettings().pathsPerPhatexel;
        const ReflectionProbe probe = bakeProbe(rays, lights, settings, progress);
        report["bakeSeconds"] = start.seconds();
        report["bytes"] = probeBytes(settings.faceSize);
        report["faceSize"] = settings.faceSize;
        writeViews(
            options, rays, material,
            [&](const Hit&, const SurfacePoint& point, glm::vec3 eye) {
                return shadeByProbe(probe, point, eye);
            },
            report);
    } else {
        GaussianSettings settings;
        // As many times fewer texels as each is larger.
        settings.texelSizeMeters =
            phatexelSize(baked, material) *
            std::sqrt(float(kGaussianTexelBytes) /
                      float(sizeof(PackedPhatexel) * baked.phatexture.indirect.size()));
        settings.raysPerTexel = options.raysPerTexel;
        settings.paths.pathsPerHit = 1;
        const GaussianLightmap lightmap = bakeGaussians(rays, lights, material, settings, progress);
        report["bakeSeconds"] = start.seconds();
        report["bytes"] = lightmap.texelCount * kGaussianTexelBytes;
        report["raysPerTexel"] = settings.raysPerTexel;
        const auto reading = options.reading == "exact" ? GaussianReading::exact : GaussianReading::warped;
        writeViews(
            options, rays, material,
            [&](const Hit& hit, const SurfacePoint& point, glm::vec3 eye) {
                return shadeByGaussians(lightmap, hit, point, eye, reading);
            },
            report);
    }
    fmt::print("{}\n", report.dump());
}

/// The first camera, moved as `phat render --eye --target` would.
Camera cameraOf(const Options& options, const Scene& scene) {
    Camera camera = firstCamera(scene, options.input);
    if (options.eye.empty()) return camera;
    const glm::vec3 eye(options.eye[0], options.eye[1], options.eye[2]);
    const glm::vec3 target(options.target[0], options.target[1], options.target[2]);
    camera.worldFromCamera = glm::inverse(glm::lookAt(eye, target, glm::vec3(0, 1, 0)));
    camera.aspect = 0;
    return camera;
}

void writeMask(const Options& options) {
    const Scene scene = loadGltf(options.input).scene;
    const RayScene rays(scene);
    Image mask = materialMask(rays, materialNamed(scene, options.material), cameraOf(options, scene),
                              options.width, options.height);
    if (!options.window.empty())
        keepWindow(mask, options.window[0], options.window[1], options.window[2], options.window[3]);
    writeExr(options.output, mask);
}

/// A picture that is black outside the mask, for FLIP, which looks at the neighbourhood.
void writeKept(const Options& options) {
    Image picture = readPicture(options.input);
    const Image mask = readPicture(options.mask);
    if (mask.width != picture.width || mask.height != picture.height)
        throw FileError(options.mask, "has another size than " + options.input);
    for (size_t i = 0; i < picture.pixels.size(); ++i)
        if (!(mask.pixels[i].x > 0.5f)) picture.pixels[i] = glm::vec3(0);
    writeExr(options.output, picture);
}

/// A shader as the renderer hands it to the driver, for compilers that count its instructions.
void writeShader(const Options& options) {
    const std::filesystem::path path(options.input);
    const ShaderSource source = assembleShader(path.parent_path().string(), path.filename().string(),
                                               GlslFlavor::desktop, options.defines);
    std::ofstream(options.output) << source.text;
}

void writeThinned(const Options& options) {
    writeExr(options.output, thinned(readPicture(options.input), options.count));
}

/// The chart of a material that the camera sees most of.
uint32_t seenChart(const BakedScene& baked, uint32_t material, const Camera& camera) {
    constexpr int kSide = 64;
    const Scene& scene = baked.loaded.scene;
    const RayScene rays(scene);
    std::vector<uint32_t> seen(baked.atlas.charts.size(), 0);
    uint64_t rayCount = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const glm::vec2 place = glm::vec2(i % kSide, i / kSide) + 0.5f;
        const Hit hit = visibleHit(rays, cameraRay(camera, kSide, kSide, place), rayCount);
        if (!hit || materialAt(scene, hit.triangle) != material) continue;
        const uint32_t chart = baked.atlas.triangleChart[hit.triangle];
        if (chart != kNoChart) ++seen[chart];
    }
    const auto most = std::max_element(seen.begin(), seen.end());
    return most == seen.end() || *most == 0 ? kNoChart : uint32_t(most - seen.begin());
}

/// That chart as its PHATexels' radiance; black where there is none.
void writeChart(const Options& options) {
    const BakedScene baked = readBakedFile(options.input);
    const Scene& scene = baked.loaded.scene;
    const uint32_t material = materialNamed(scene, options.material);
    const uint32_t seen = seenChart(baked, material, firstCamera(scene, options.input));
    if (seen == kNoChart) throw FileError(options.input, "shows no PHATexels of " + options.material);
    const Chart& chart = baked.atlas.charts[seen];
    const glm::uvec2 origin = chart.originTexel(), size = chart.sizeTexels();
    Image picture(int(size.x), int(size.y));
    for (uint32_t y = 0; y < size.y; ++y) {
        for (uint32_t x = 0; x < size.x; ++x) {
            const Phatexel phatexel =
                phatexelAt(baked.phatexture.indirect.front(), baked.phatexture.indirectGuides, baked.atlas,
                           origin + glm::uvec2(x, y));
            if (phatexel.valid) picture.at(int(x), int(y)) = phatexel.radiance;
        }
    }
    writeExr(options.output, picture);
}

/// Crops to the middle, shrinks by averaging blocks, tone-maps.
void writeScreen(const Options& options) {
    const Image image = readPicture(options.input);
    const int width = image.width / options.zoom, height = image.height / options.zoom;
    const int left = (image.width - width) / 2, top = (image.height - height) / 2;
    Image small(width / options.shrink, height / options.shrink);
    if (small.pixels.empty()) throw FileError(options.input, "nothing is left of the picture");
    for (int y = 0; y < small.height; ++y) {
        for (int x = 0; x < small.width; ++x) {
            glm::vec3 sum(0);
            for (int i = 0; i < options.shrink * options.shrink; ++i)
                sum += image.at(left + x * options.shrink + i % options.shrink,
                                top + y * options.shrink + i / options.shrink);
            small.at(x, y) = sum / float(options.shrink * options.shrink);
        }
    }
    writePng(options.output, toneMap(small, ToneMap::agx, options.exposureStops));
}

int run(int argc, char** argv) {
    CLI::App app("Peers of PHATextures, and pictures of them");
    app.require_subcommand(1);
    Options options;
    std::string size;
    const auto files = [&](CLI::App* command) {
        command->add_option("IN", options.input)->required();
        command->add_option("-o,--output", options.output)->required();
        return command;
    };
    const auto parseSize = [&] {
        char end = 0;
        if (size.empty()) return;
        if (std::sscanf(size.c_str(), "%dx%d%c", &options.width, &options.height, &end) != 2 ||
            options.width < 1 || options.height < 1 || options.width > 16384 || options.height > 16384)
            throw CLI::ValidationError("--size", "is not WxH");
    };
    CLI::App* peer = files(app.add_subcommand("render",
                                              "Bake a peer of as many bytes as a baked file's "
                                              "PHATexels, draw its glossy indirect light as .exr"));
    peer->add_option("--peer", options.peer)->required()->check(CLI::IsMember({"probe", "gaussians"}));
    peer->add_option("--material", options.material, "The only one that is drawn")->required();
    peer->add_option("--roughness", options.roughness, "One picture each; {} in the output's name");
    peer->add_option("--size", size, "WxH");
    peer->add_option("--spp", options.samplesPerPixel)->check(CLI::Range(1, 65536));
    peer->add_option("--at", options.place, "The probe's x y z; default: the middle of the scene")
        ->expected(3);
    peer->add_flag("--center", options.center, "Show the middles of pixels");
    peer->add_option("--reading", options.reading, "Of gaussians")->check(CLI::IsMember({"warped", "exact"}));
    peer->add_option("--rays", options.raysPerTexel, "A texel of gaussians")->check(CLI::Range(1, 65536));
    peer->callback([&] { parseSize(), renderPeer(options); });

    CLI::App* mask = files(app.add_subcommand("mask", "Where the first camera sees a material"));
    mask->add_option("--material", options.material)->required();
    mask->add_option("--size", size, "WxH");
    CLI::Option* eye = mask->add_option("--eye", options.eye, "x y z")->expected(3);
    CLI::Option* target = mask->add_option("--target", options.target, "x y z")->expected(3)->needs(eye);
    eye->needs(target);
    mask->add_option("--window", options.window, "x y width height: nothing outside")->expected(4);
    mask->callback([&] { parseSize(), writeMask(options); });

    CLI::App* thin = files(app.add_subcommand("thin", "So many pixels of a mask, scattered at random"));
    thin->add_option("--count", options.count)->required()->check(CLI::PositiveNumber);
    thin->callback([&] { writeThinned(options); });

    CLI::App* keep = files(app.add_subcommand("keep", "A picture, black outside a mask"));
    keep->add_option("--mask", options.mask)->required();
    keep->callback([&] { writeKept(options); });

    CLI::App* shader = files(app.add_subcommand("shader", "A shader with its includes"));
    shader->add_option("--define", options.defines);
    shader->callback([&] { writeShader(options); });

    CLI::App* chart = files(app.add_subcommand(
        "chart", "Radiance of the PHATexels of a material, of the chart that is seen most"));
    chart->add_option("--material", options.material)->required();
    chart->callback([&] { writeChart(options); });

    CLI::App* screen = files(app.add_subcommand("screen", "A picture as a screen shows it, .png"));
    screen->add_option("--exposure", options.exposureStops)->check(CLI::Range(-40.0, 40.0));
    screen->add_option("--shrink", options.shrink)->check(CLI::Range(1, 64));
    screen->add_option("--zoom", options.zoom, "Only the middle 1/N of each side")->check(CLI::Range(1, 64));
    screen->callback([&] { writeScreen(options); });
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const std::exception& error) {
        fmt::print(stderr, "phat_peers: {}\n", error.what());
        return 1;
    }
    return 0;
}

}  // namespace
}  // namespace phat::peers

int main(int argc, char** argv) {
    return phat::peers::run(argc, argv);
}
