// Putting a bake on the GPU, and frames by pass.

#include "bench_scene.h"
#include "core/bake/bake.h"
#include "gl/gl_context.h"
#include "gl/renderer.h"

namespace phat {
namespace {

constexpr const char* kShaders = PHAT_SOURCE_DIR "/shaders";

// As `phat bake` makes it without flags: the lookup's time depends on what is stored.
struct BakedRoom {
    explicit BakedRoom(const std::string& name) : scene(benchScene(name)) {
        SilentProgress progress;
        bake = phat::bake(scene, BakeSettings(), progress);
    }
    RendererInput input() const { return {scene, bake.atlas, bake.points, bake.phatexture}; }

    Scene scene;
    Bake bake;
};

const BakedRoom& bakedRoom(const std::string& name) {
    static std::map<std::string, BakedRoom> rooms;
    return rooms.try_emplace(name, name).first->second;
}

FrameSettings frameOf(const Scene& scene, Method method, int samplesPerPixel) {
    FrameSettings frame;
    frame.width = 640;
    frame.height = 360;
    frame.camera = scene.cameras.front();
    frame.method = method;
    frame.samplesPerPixel = samplesPerPixel;
    return frame;
}

// One iteration makes a renderer of a bake in memory; its programs are compiled with the first frame.
void makeRenderer(benchmark::State& state, const std::string& name) {
    const BakedRoom& room = bakedRoom(name);
    const HeadlessContext context;
    for (auto _ : state) Renderer(room.input(), kShaders);
    Renderer renderer(room.input(), kShaders);
    const auto perTexel = [&] {
        return double(renderer.residentBytes().sum()) / double(room.bake.atlas.texelCount());
    };
    state.counters["bytes_per_texel"] = perTexel();
    const double drawing = secondsOf([&] { renderer.render(frameOf(room.scene, Method::phatPyramid, 1)); });
    const double again = secondsOf([&] { renderer.render(frameOf(room.scene, Method::phatPyramid, 1)); });
    state.counters["first_pyramid_ms"] = 1e3 * (drawing - again);
    state.counters["bytes_per_texel_pyramid"] = perTexel();
    state.SetLabel(context.rendererName());
}

// One iteration is a frame of one sample a pixel, as the window draws it while something moves.
void drawFrames(benchmark::State& state, const std::string& name, Method method) {
    const BakedRoom& room = bakedRoom(name);
    const HeadlessContext context;
    Renderer renderer(room.input(), kShaders);
    FrameSettings frame = frameOf(room.scene, method, 1);
    renderer.render(frame);  // shadow maps and compilers
    std::array<double, kGpuPasses.size()> seconds{};
    for (auto _ : state) {
        // Another eye each time, for which the pyramid is made anew.
        frame.camera.worldFromCamera[3].x += 1e-4f;
        benchmark::DoNotOptimize(renderer.render(frame));
        const FrameTimes times = renderer.lastFrameTimes();
        for (size_t i = 0; i < seconds.size(); ++i) seconds[i] += times.*kGpuPasses[i].seconds;
    }
    for (size_t i = 0; i < seconds.size(); ++i)
        state.counters[std::string(kGpuPasses[i].name) + "_ms"] =
            1e3 * seconds[i] / double(state.iterations());
    if (method == Method::phat) {
        frame.inspection = {Inspected::reads};
        const Image reads = renderer.render(frame);
        state.counters["reads_per_pixel"] = countReads(reads, 0).mean + countReads(reads, 1).mean;
    }
    state.SetLabel(context.rendererName());
}

void tenTimes(benchmark::internal::Benchmark* measured) {
    measured->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(10);
}
BENCHMARK_CAPTURE(makeRenderer, tabletop, "tabletop")->Apply(tenTimes);
BENCHMARK_CAPTURE(makeRenderer, gallery, "gallery")->Apply(tenTimes);
BENCHMARK_CAPTURE(drawFrames, tabletop, "tabletop", Method::phat)->Apply(tenTimes);
BENCHMARK_CAPTURE(drawFrames, gallery, "gallery", Method::phat)->Apply(tenTimes);
BENCHMARK_CAPTURE(drawFrames, tabletop_pyramid, "tabletop", Method::phatPyramid)->Apply(tenTimes);
BENCHMARK_CAPTURE(drawFrames, gallery_pyramid, "gallery", Method::phatPyramid)->Apply(tenTimes);

}  // namespace
}  // namespace phat
