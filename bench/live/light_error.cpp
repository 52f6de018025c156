// phat_light_error: how far the light of a bake whose scene has changed is from that of the new scene, by the
// rays that the engine of the CPU, or of the GPU, has traced for it.
//
// The error is that of looked-up pictures against the mean of pictures from bakes of the new scene with other
// random numbers; that of one bake of it is printed beside.

#include <CLI/CLI.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/dynamic/incremental_baker.h"
#include "core/render/metrics.h"
#include "core/scene/default_camera.h"
#include "gl/gl_context.h"
#include "gl/light_turns.h"
#include "io/image/image_file.h"
#include "io/phat/bake_record.h"
#include "io/phat/baked_file.h"

namespace phat {
namespace {

// Light that is reflected sharply so many times is brought to what the GPU sees.
constexpr int kAdaptions = 3;

struct Options {
    std::string baked, node = "crate", pictures;
    float meters = -0.2f, raysPerTexel = 48;
    int references = 12, width = 320, height = 180;
};

void print(const nlohmann::json& line) {
    std::cout << line.dump() << std::endl;
}

/// A scene that is about to change, and pictures of it.
class Jump {
  public:
    explicit Jump(const Options& options)
        : options_(options),
          baked_(readBakedFile(options.baked)),
          posed_(std::move(baked_.loaded.scene)),
          bvh_(buildSceneBvh(scene())),
          settings_(settingsOf(baked_.record)),
          rects_(blockRects(baked_.atlas)) {
        frame_.width = options.width;
        frame_.height = options.height;
        frame_.camera = scene().cameras.empty() ? defaultCamera(scene()) : scene().cameras.front();
        state_ = {{}, scene().lights, scene().materials};
        state_.worldFromRest.assign(scene().nodes.size(), glm::mat4(1));
        for (size_t n = 0; n < scene().nodes.size(); ++n)
            if (scene().nodes[n].name == options.node)
                state_.worldFromRest[n] = glm::translate(glm::mat4(1), {options.meters, 0, 0});
        for (size_t i = 0; i < baked_.points.state.size(); ++i) validTexels_ += baked_.points.valid(i);
    }
    /// Prints a line of JSON for each picture.
    void measure();

  private:
    const Scene& scene() const { return posed_.rest(); }
    const std::string shaders_ = PHAT_SOURCE_DIR "/shaders";
    RendererInput input() const { return {scene(), baked_.atlas, baked_.points, baked_.phatexture, &bvh_}; }
    void moveRenderer(Renderer& renderer, IncrementalBaker& engine) const;
    double errorOf(Renderer& renderer) const;
    void keep(const char* name, const Image& picture) const;
    void makeReference(IncrementalBaker& engine);
    void byCpu(IncrementalBaker& engine);
    void byGpu(LightUpdate geometry, IncrementalBaker& engine);
    uint64_t raysOf(const BlockTurn& turn) const;

    Options options_;
    BakedScene baked_;
    PosedScene posed_;
    SceneBvh bvh_;
    BakeSettings settings_;
    SceneState state_;
    FrameSettings frame_;
    Image reference_;
    double bakeError_ = 0;
    size_t validTexels_ = 0;
    std::vector<BlockRect> rects_;
    SilentProgress progress_;
};

void Jump::moveRenderer(Renderer& renderer, IncrementalBaker& engine) const {
    renderer.moveScene(engine.scene().scene(), baked_.atlas, engine.scene().points(), state_.worldFromRest);
    renderer.setLights(state_.lights);
}

double Jump::errorOf(Renderer& renderer) const {
    return compareImages(renderer.render(frame_), reference_).maeOverMean;
}

void Jump::keep(const char* name, const Image& picture) const {
    if (!options_.pictures.empty()) writeExr(options_.pictures + "/" + name + ".exr", picture);
}

// The engine is left as a bake of the new scene.
void Jump::makeReference(IncrementalBaker& engine) {
    Renderer renderer(input(), shaders_);
    moveRenderer(renderer, engine);
    const auto picture = [&] {
        engine.converge(progress_);
        LightUpdate update = engine.drainUpdate();
        while (!renderer.takeUpdate(update, 1)) continue;
        return renderer.render(frame_);
    };
    const Image bake = picture();
    for (int i = 0; i < options_.references; ++i) {
        engine.refine();
        const Image next = picture();
        if (i == 0) reference_ = next;
        for (size_t p = 0; i > 0 && p < next.pixels.size(); ++p)
            reference_.pixels[p] += (next.pixels[p] - reference_.pixels[p]) / float(i + 1);
    }
    bakeError_ = compareImages(bake, reference_).maeOverMean;
    keep("reference", reference_);
    keep("bake", bake);
}

void Jump::byCpu(IncrementalBaker& engine) {
    Renderer renderer(input(), shaders_);
    moveRenderer(renderer, engine);
    uint64_t rays = 0, next = validTexels_;
    while (!engine.converged()) {
        rays += engine.advance(validTexels_ / 4, progress_);
        if (rays < next && !engine.converged()) continue;
        next = rays + rays / 4;
        LightUpdate update = engine.drainUpdate();
        while (!renderer.takeUpdate(update, 1)) continue;
        print({{"engine", "cpu"},
               {"rays", rays},
               {"phatexels", engine.stats().phatexels},
               {"error", errorOf(renderer)}});
    }
}

/// Rays of a turn, one a texel and kind.
uint64_t Jump::raysOf(const BlockTurn& turn) const {
    const BlockRect& rect = rects_[turn.block];
    uint64_t texels = 0;
    for (uint32_t y = 0; y < rect.size.y; ++y)
        for (uint32_t x = 0; x < rect.size.x; ++x)
            texels += baked_.points.valid(size_t(rect.origin.y + y) * baked_.atlas.sizeTexels.x +
                                          rect.origin.x + x);
    const uint64_t layers = baked_.phatexture.indirect.size() + baked_.phatexture.area.size();
    return texels *
           ((turn.work != BlockWork::irradiance ? layers : 0) + (turn.work != BlockWork::check ? 2 : 0));
}

void Jump::byGpu(LightUpdate geometry, IncrementalBaker& engine) {
    Renderer renderer(input(), shaders_);
    renderer.beginLight(input());
    BlockOrder order(baked_.atlas, baked_.points);
    uint32_t number = 0;
    // What was baked is brought to what the GPU sees along the same rays, so that changes can be told from
    // that.
    const std::vector<BlockTurn> all = order.next(order.size(), frame_.camera);
    for (int i = 0; i < kAdaptions; ++i)
        renderer.traceLight({.blocks = all, .number = ++number, .irradiance = false});
    keep("adapted", renderer.render(frame_));
    moveRenderer(renderer, engine);
    while (!renderer.takeUpdate(geometry, 1)) continue;
    order = BlockOrder(baked_.atlas, baked_.points);
    uint64_t rays = 0, phatexels = 0, next = 0, checks = 0;
    while (!order.settled() && double(rays) < double(options_.raysPerTexel) * double(validTexels_)) {
        const std::vector<BlockTurn> turns = order.next(order.size() / 8 + 1, frame_.camera);
        for (const BlockTurn& turn : turns) {
            rays += raysOf(turn);
            if (turn.work != BlockWork::irradiance) phatexels += raysOf({turn.block, 0, BlockWork::check});
            checks += turn.work == BlockWork::check;
        }
        takeTurns(renderer, order, turns, number);
        if (rays < next && !order.settled()) continue;
        next = rays + std::max<uint64_t>(rays / 4, validTexels_ / 2);
        renderer.filterLight();
        print({{"engine", "gpu"},
               {"rays", rays},
               {"phatexels", phatexels},
               {"checks", checks},
               {"error", errorOf(renderer)}});
    }
    keep("gpu", renderer.render(frame_));
}

void Jump::measure() {
    const HeadlessContext context;
    IncrementalBaker engine(posed_.snapshotAtRest(), baked_.atlas, baked_.points, baked_.phatexture,
                            settings_);
    posed_.setState(state_);
    engine.setScene(posed_.snapshot());
    const LightUpdate geometry = engine.drainUpdate();
    makeReference(engine);
    IncrementalBaker other(posed_.snapshotAtRest(), baked_.atlas, baked_.points, baked_.phatexture,
                           settings_);
    other.setScene(posed_.snapshot());
    {
        Renderer untouched(input(), shaders_);
        moveRenderer(untouched, other);
        print({{"texels", validTexels_},
               {"blocks", rects_.size()},
               {"bakeError", bakeError_},
               {"errorBefore", errorOf(untouched)}});
    }
    byGpu(geometry, other);
    byCpu(other);
}

}  // namespace
}  // namespace phat

int main(int argc, char** argv) {
    phat::Options options;
    CLI::App app("Error of light that follows a jump, by rays");
    app.add_option("BAKED", options.baked)->required();
    app.add_option("--node", options.node, "What jumps");
    app.add_option("--meters", options.meters, "How far, along x; 0: nothing changes");
    app.add_option("--rays-per-texel", options.raysPerTexel, "Of the GPU, at most");
    app.add_option("--pictures", options.pictures,
                   "Folder: the reference, a bake, the GPU's at first and last");
    app.add_option("--references", options.references, "Bakes whose mean is the reference");
    CLI11_PARSE(app, argc, argv);
    try {
        phat::Jump(options).measure();
    } catch (const std::exception& error) {
        std::cerr << "phat_light_error: " << error.what() << "\n";
        return 1;
    }
}
