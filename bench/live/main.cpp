// phat_live: frame times while the light is updated on another core against those of converged light, and
// PHATexels a second of the update against those of a bake.
//
// The drawing has one core (LP_NUM_THREADS=1 where OpenGL is Mesa's), the baker another.

#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/base/stopwatch.h"
#include "core/dynamic/baker_thread.h"
#include "core/scene/default_camera.h"
#include "core/transport/photon_map.h"
#include "gl/gl_context.h"
#include "gl/picture_sum.h"
#include "gl/renderer.h"
#include "io/phat/bake_record.h"
#include "io/phat/baked_file.h"

namespace phat {
namespace {

// As the window's.
constexpr double kUploadSeconds = 0.004;
// Of an upload between the frames that are measured.
constexpr double kDrainSeconds = 1;
// Frames of either kind follow each other so closely that other work on the machine meets both.
constexpr int kFramesATurn = 5;

struct Options {
    std::string baked, node = "crate", out;
    float meters = -0.2f;
    int width = 640, height = 360, frames = 20;
};

double quantile(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values.at(size_t(share * double(values.size() - 1) + 0.5));
}

nlohmann::json summary(const std::vector<double>& seconds) {
    return {{"frames", seconds.size()},
            {"medianMs", 1e3 * quantile(seconds, 0.5)},
            {"p95Ms", 1e3 * quantile(seconds, 0.95)}};
}

// The baker updates photons and gathered light; atlas and seams stay.
double bakeProcessorSeconds(const Scene& scene, const BakedScene& baked, const BakeSettings& settings) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    SilentProgress progress;
    const RayScene rays(scene);
    const LightSampler lights(scene);
    const std::vector<Frame> frames = blockFrames(baked.atlas, baked.points);
    const std::vector<uint8_t> receives = irradianceTexels(baked.atlas, baked.points);
    const double start = threadProcessorSeconds();
    const PhotonMap photons = tracePhotons(rays, lights, settings.photons, progress);
    const PhotonIndex index(photons.photons);
    std::atomic<uint64_t> rayCount = 0;
    gatherLight({{rays, lights, baked.atlas, baked.points, frames, photons, index, receives},
                 settings,
                 progress,
                 nullptr,
                 rayCount});
    return threadProcessorSeconds() - start;
}

SceneState moved(const Scene& scene, const Options& options, bool away) {
    SceneState pose{{}, scene.lights, scene.materials};
    pose.worldFromRest.assign(scene.nodes.size(), glm::mat4(1));
    for (size_t n = 0; n < scene.nodes.size(); ++n)
        if (scene.nodes[n].name == options.node && away)
            pose.worldFromRest[n] = glm::translate(glm::mat4(1), {options.meters, 0, 0});
    return pose;
}

nlohmann::json measure(const Options& options) {
    double load = 0;  // of other work: 1 for each busy core
    getloadavg(&load, 1);
    BakedScene baked = readBakedFile(options.baked);
    PosedScene posed(std::move(baked.loaded.scene));
    const Scene& scene = posed.rest();
    const BakeSettings settings = settingsOf(baked.record);
    const HeadlessContext context;
    Renderer renderer({scene, baked.atlas, baked.points, baked.phatexture}, PHAT_SOURCE_DIR "/shaders");
    FrameSettings frame;
    frame.width = options.width;
    frame.height = options.height;
    frame.camera = scene.cameras.empty() ? defaultCamera(scene) : scene.cameras.front();
    frame.samplesPerPixel = 1;
    PictureSum sum;
    renderer.draw(frame, sum);
    renderer.lastFrameTimes();

    BakerThread light({posed.snapshotAtRest(), baked.atlas, baked.points, baked.phatexture, settings}, 1,
                      [] {});
    light.waitUntilStarted();
    const auto snapshotOf = [&](bool isAway) {
        posed.setState(moved(scene, options, isAway));
        return posed.snapshot();
    };
    LightUpdate update;
    const auto receive = [&](double uploadSeconds) {
        if (update.empty())
            if (auto next = light.take()) update = std::move(*next);
        if (!update.empty()) renderer.takeUpdate(update, uploadSeconds);
    };
    const auto draw = [&] {
        const Stopwatch start;
        receive(kUploadSeconds);
        renderer.draw(frame, sum);
        renderer.lastFrameTimes();  // waits
        return start.seconds();
    };
    std::vector<double> idle, updating;
    bool away = false;
    for (int turn = 0; int(updating.size()) < options.frames; ++turn) {
        if (light.report().converged) away = !away;
        light.follow(snapshotOf(away), frame.camera, true);
        for (int i = 0; i < kFramesATurn && !light.report().converged; ++i) updating.push_back(draw());
        light.follow(snapshotOf(away), frame.camera, false);
        while (!light.report().converged || !update.empty()) {  // what it still hands over
            receive(kDrainSeconds);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        for (int i = 0; i < kFramesATurn; ++i) idle.push_back(draw());
    }
    // From the untouched light to that of the other place, to the end.
    light.follow(snapshotOf(false), frame.camera, true);
    const auto settle = [&] {
        while (!light.report().converged) draw();
        return light.report().processorSeconds;
    };
    const double before = settle();
    const uint64_t updatedBefore = light.report().phatexels;
    light.follow(snapshotOf(true), frame.camera, true);
    const double seconds = settle() - before;
    const uint64_t updates = light.report().phatexels - updatedBefore;
    uint64_t valid = 0;
    for (size_t i = 0; i < baked.points.state.size(); ++i) valid += baked.points.valid(i);
    valid *= baked.phatexture.indirect.size() + baked.phatexture.area.size();
    const double whole = bakeProcessorSeconds(scene, baked, settings);
    const double speed = double(valid) / seconds, bakeSpeed = double(valid) / whole;
    return {{"gpu", context.rendererName()},
            {"loadBefore", load},
            {"width", options.width},
            {"height", options.height},
            {"idle", summary(idle)},
            {"updating", summary(updating)},
            {"phatexels", valid},
            {"renewal",
             {{"processorSeconds", seconds},
              {"phatexelsPerSecond", speed},
              {"updates", updates},
              {"updatesPerSecond", double(updates) / seconds}}},
            {"bake", {{"processorSeconds", whole}, {"phatexelsPerSecond", bakeSpeed}}},
            {"longestPieceMs", 1e3 * light.report().longestSeconds}};
}

}  // namespace
}  // namespace phat

int main(int argc, char** argv) {
    setenv("LP_NUM_THREADS", "1", 0);
    phat::Options options;
    CLI::App app("What light that follows costs the window");
    app.add_option("BAKED", options.baked)->required();
    app.add_option("--node", options.node, "What moves there and back");
    app.add_option("--meters", options.meters, "How far, along x");
    app.add_option("--frames", options.frames, "Of each kind");
    app.add_option("-o", options.out, "JSON; default: the terminal");
    CLI11_PARSE(app, argc, argv);
    try {
        const std::string text = phat::measure(options).dump(1) + "\n";
        if (options.out.empty())
            std::cout << text;
        else
            std::ofstream(options.out) << text;
    } catch (const std::exception& error) {
        std::cerr << "phat_live: " << error.what() << "\n";
        return 1;
    }
}
