// A frame by pass, and what the display pass reads.

#include <filesystem>
#include <fstream>
#include <sstream>

#include "bench_scene.h"
#include "core/bake.h"
#include "gl/gl_context.h"
#include "gl/renderer.h"

namespace phat {
namespace {

namespace fs = std::filesystem;

const fs::path kShaders = PHAT_SOURCE_DIR "/shaders";

// The time of a frame depends on the number of texels, hardly on their light: a cheap bake will do.
struct BakedRoom {
    explicit BakedRoom(const std::string& name) : scene(benchScene(name)) {
        BakeSettings settings;
        settings.atlas.texelBudget = 262'144;
        settings.photons.count = 50'000;
        settings.pathsPerPhatexel = 1;
        settings.irradianceSamples = 4;
        SilentProgress progress;
        bake = phat::bake(scene, settings, progress);
    }
    RendererInput input() const { return {scene, bake.atlas, bake.points, bake.phatexture}; }

    Scene scene;
    Bake bake;
};

FrameSettings frameOf(const Scene& scene, int samplesPerPixel) {
    FrameSettings frame;
    frame.width = 640;
    frame.height = 480;
    frame.camera = scene.cameras.front();
    frame.samplesPerPixel = samplesPerPixel;
    return frame;
}

// A copy of the shaders whose display pass draws the number of its texelFetch calls.
class CountingShaders {
  public:
    CountingShaders() {
        std::string name = (fs::temp_directory_path() / "phat-bench-XXXXXX").string();
        if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
        folder = name;
        fs::copy(kShaders, folder, fs::copy_options::recursive);
        std::ifstream file(kShaders / "display.frag");
        std::stringstream text;
        text << "int reads = 0;\n"
                "#define texelFetch(texels, place, level) (++reads, texelFetch(texels, place, level))\n"
             << file.rdbuf();
        std::string source = text.str();
        const std::string result = "radiance = vec4(sum * alpha, alpha);";
        const size_t place = source.find(result);
        if (place == std::string::npos) throw std::runtime_error("display.frag writes its result otherwise");
        source.replace(place, result.size(), "radiance = vec4(vec3(float(reads)), 1.0);");
        std::ofstream(folder / "display.frag") << source;
    }
    ~CountingShaders() { fs::remove_all(folder); }
    CountingShaders(const CountingShaders&) = delete;
    CountingShaders& operator=(const CountingShaders&) = delete;

    fs::path folder;
};

double readsPerPixel(const BakedRoom& room) {
    const CountingShaders shaders;
    Renderer renderer(room.input(), shaders.folder.string());
    const Image counts = renderer.render(frameOf(room.scene, 1));
    double sum = 0;
    for (const glm::vec3& pixel : counts.pixels) sum += pixel.x;
    return sum / double(counts.pixels.size());
}

// One iteration is a frame without anti-aliasing and one with the default's.
void renderFrames(benchmark::State& state, const std::string& name) {
    const BakedRoom room(name);
    const HeadlessContext context;
    Renderer renderer(room.input(), kShaders.string());
    const FrameSettings aliased = frameOf(room.scene, 1);
    const FrameSettings smooth = frameOf(room.scene, FrameSettings().samplesPerPixel);
    renderer.render(aliased);  // shadow maps and compilers
    FrameTimes sum;
    double smoothDisplay = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(renderer.render(aliased));
        const FrameTimes times = renderer.lastFrameTimes();
        sum.relight += times.relight;
        sum.pyramid += times.pyramid;
        sum.display += times.display;
        benchmark::DoNotOptimize(renderer.render(smooth));
        smoothDisplay += renderer.lastFrameTimes().display;
    }
    const double toMilliseconds = 1e3 / double(state.iterations());
    state.counters["relight_ms"] = toMilliseconds * sum.relight;
    state.counters["pyramid_ms"] = toMilliseconds * sum.pyramid;
    state.counters["display_ms_1_sample"] = toMilliseconds * sum.display;
    state.counters["display_ms_default_samples"] = toMilliseconds * smoothDisplay;
    state.counters["display_reads_per_pixel"] = readsPerPixel(room);
    state.SetLabel(context.rendererName());
}
BENCHMARK_CAPTURE(renderFrames, tabletop, "tabletop")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(2);
BENCHMARK_CAPTURE(renderFrames, gallery, "gallery")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(2);

}  // namespace
}  // namespace phat
