#pragma once
// The OpenGL 4.5 renderer: lookup, or relight and pyramid; then display. source: Hensley et al. 2003, section
// 6; the lookup is ours.
//
// Needs a current context (HeadlessContext, or the viewer's window). Draws what phat render writes and what
// the viewer shows; holds no light transport of its own.

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/atlas/atlas.h"
#include "core/base/image.h"
#include "core/bvh/posed_bvh.h"
#include "core/dynamic/light_update.h"
#include "core/phatexel/phatexture.h"
#include "core/probes/light_probes.h"
#include "core/render/picture.h"
#include "core/render/traced_reflections.h"
#include "core/scene/scene.h"
#include "gl/light_round.h"

namespace phat {

struct PictureSum;

/// Where indirect light on glossy surfaces comes from.
enum class Method : uint8_t {
    phat,         // looked up by the pixel: BRDF samples with the radiance of PHATexels around
    phatPyramid,  // the paper's passes: the BRDF on every PHATexel, a pyramid, a cone
    phatPaper,    // the same to the letter: no densities, plain means, the paper's filter; diffuse light too
};
/// Numbers of samples of the lookup: see docs/lookup.md for reads a pixel.
enum class Quality : uint8_t { fast, standard, high };  // `standard`: `default` of the command line
enum class ToneMap : uint8_t { linear, agx, aces };

/// Stored data that can be shown instead of the light. twin: shaders/inspect.frag.
enum class Inspected : uint8_t {
    nothing,    // the light
    radiance,   // of the PHATexels: light, as figure 4 of the paper shows it
    direction,  // of the PHATexels, world: x, y, z as red, green, blue, each from -1 to 1
    distance,   // of the PHATexels, units of length: black .01, red .22, yellow 4.6, white 100
    validity,   // green: holds a value; red: none
    charts,     // a colour each, with their tiles
    density,    // a checker of texels; blue as coarse as anywhere, red an eighth
    pyramid,    // a level of the relit PHATexels: light
    samples,    // effective number in the pyramid's cone: black 1, red 6, yellow 40, white 256
    reads,  // of texels by the lookup: red for indirect light, green for area lights; the numbers themselves
};
struct Inspection {
    Inspected what = Inspected::nothing;
    int source = 0;  // 0: indirect light, 1: area lights, if there are any
    int layer = 0;   // of several PHATexels a texel
    int level = 0;   // of the pyramid
};

/// How many reflection rays the GPU traces for a frame.
struct RayBudget {
    float perNeighborhood = 24;  // that count for a pixel's lobe, its neighbours' included
    int maxPerPixel = 8;         // of a lobe's own, at most 32
    int lightSamples = 1;        // of a lobe of a pixel, toward emitters
};

struct FrameSettings {
    int width = 640;
    int height = 360;
    Camera camera;
    Method method = Method::phat;         // phatPyramid where directions follow no invertible layout
    Quality quality = Quality::standard;  // of Method::phat
    Component component = Component::all;
    /// Which lobes the GPU traces, of Method::phat; `lookup` where the renderer has no trees.
    Reflections tracedByGpu = Reflections::lookup;
    RayBudget rays;
    /// Of a view that moves: the rays of the frame that was drawn last count, too, where it showed the same.
    bool followsLast = false;
    uint32_t seed = 0;  // of the GPU's rays: another one for each frame that follows
    Inspection inspection;
    /// Anti-aliasing: this many whole pictures, shifted inside the pixel, are averaged (a box filter of one
    /// pixel, over edges, textures and highlights alike). 1 turns it off.
    int samplesPerPixel = 4;
    /// With `center` they are not shifted, nor textures filtered: the mean of what frames of a still view
    /// show there.
    PixelFilter filter = PixelFilter::box;
    /// How many of them one draw() adds; 0: all.
    int samplesPerDraw = 0;
    /// The first picture of a renderer, and those for as long as the driver compiles in the background, may
    /// be a preview of one sample: base colours by diffuse light (shaders/preview.frag).
    bool mayPreview = false;
};

/// Pixels; at least one.
inline glm::uvec2 sizeOf(const FrameSettings& settings) {
    return {std::max(settings.width, 1), std::max(settings.height, 1)};
}

/// How many samples Renderer::draw adds to `sum`.
int samplesToDraw(const FrameSettings& settings, const PictureSum& sum);

/// One sample of a frame, drawn up to its display pass.
struct PendingSample {
    FrameSettings settings;               // as far as the bake can show them
    Reflections reflections;              // which lobes are traced
    glm::vec2 jitter{0};                  // of the image plane, pixels
    ReflectionView view;                  // the frame as the rays' estimator needs it
    std::vector<TracedSurface> surfaces;  // whose lobes are traced; none where all is looked up
    std::vector<TracedSurface> panes;     // the same of the nearest glass in front of them
    bool preview = false;                 // see FrameSettings::mayPreview
};

/// What rays brought to the surfaces of a PendingSample, and to its panes.
struct TracedIncident {
    std::vector<SurfaceIncident> surfaces, panes;
};

/// Whether a view is of radiance, for a tone map; else of display-linear colours, or Inspected::reads.
inline bool showsLight(Inspected what) {
    return what == Inspected::nothing || what == Inspected::radiance || what == Inspected::pyramid;
}

/// Of a picture of Inspected::reads, over the pixels that show a surface. `source` as in Inspection.
struct ReadCount {
    double mean = 0, most = 0;
};
ReadCount countReads(const Image& picture, int source);

/// Seconds by pass on the GPU, of all samples that a draw added.
struct FrameTimes {
    double relight = 0;
    double pyramid = 0;
    double shadows = 0;  // when lights or things have changed
    double depth = 0;    // with the background
    double lobes = 0;
    double lookup = 0;
    double pool = 0;
    // Reflection rays by the GPU, see gl/ray_pass.h.
    double rayGuides = 0;
    double rayTrace = 0;
    double rayShade = 0;
    double rayLights = 0;
    double rayPool = 0;
    double display = 0;

    double gpu() const;
    double rays() const { return rayGuides + rayTrace + rayShade + rayLights + rayPool; }
};
/// The GPU's passes in the order in which they run.
struct NamedPass {
    const char* name;
    double FrameTimes::*seconds;
};
inline constexpr std::array<NamedPass, 13> kGpuPasses = {{{"relight", &FrameTimes::relight},
                                                          {"pyramid", &FrameTimes::pyramid},
                                                          {"shadows", &FrameTimes::shadows},
                                                          {"depth", &FrameTimes::depth},
                                                          {"lobes", &FrameTimes::lobes},
                                                          {"lookup", &FrameTimes::lookup},
                                                          {"pool", &FrameTimes::pool},
                                                          {"rayGuides", &FrameTimes::rayGuides},
                                                          {"rayTrace", &FrameTimes::rayTrace},
                                                          {"rayShade", &FrameTimes::rayShade},
                                                          {"rayLights", &FrameTimes::rayLights},
                                                          {"rayPool", &FrameTimes::rayPool},
                                                          {"display", &FrameTimes::display}}};
inline double FrameTimes::gpu() const {
    double sum = 0;
    for (const NamedPass& pass : kGpuPasses) sum += this->*pass.seconds;
    return sum;
}

/// Bytes in the GPU's memory.
struct ResidentBytes {
    uint64_t scene = 0;  // triangles, textures, environment
    uint64_t phatexels = 0;
    uint64_t lookup = 0;      // inverse CDFs, depth probes, tile patches
    uint64_t irradiance = 0;  // diffuse light
    uint64_t pyramid = 0;     // with what relighting reads
    uint64_t shadows = 0;
    uint64_t rays = 0;   // trees, and what rays hit
    uint64_t frame = 0;  // targets of the picture's size

    uint64_t sum() const {
        return scene + phatexels + lookup + irradiance + pyramid + shadows + rays + frame;
    }
};

/// Things that were not in the bake, with the probes that light them. The renderer reads both when it is
/// made.
struct AddedThings {
    const Scene& scene;
    const LightProbes& probes;
};

/// The parts of a bake that the renderer reads. Scene, atlas and points must outlive it: a picture that needs
/// the surface under every texel (the pyramid's methods, blended surfaces, views of data) reads them when it
/// is first drawn. The PHATexels are read by the constructor alone.
struct RendererInput {
    const Scene& scene;
    const Atlas& atlas;
    const TexelPoints& points;
    const Phatexture& phatexture;
    const SceneBvh* bvh = nullptr;  // of the scene at rest, for rays on the GPU; must outlive the renderer
    const AddedThings* added = nullptr;  // drawn but by the methods of views of data; null: none
};

class Renderer {
  public:
    /// `shaderFolder`: where shaders/ is. Throws GlError.
    Renderer(const RendererInput& input, const std::string& shaderFolder);
    ~Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    /// Adds samples to `sum`, which begins anew when its size or its number of samples is not this picture's.
    /// All reflections are looked up. A preview ends it: see PictureSum::preview.
    void draw(const FrameSettings& settings, PictureSum& sum);
    /// The same, from the first sample on, in linear radiance, row 0 on top. Waits for the GPU.
    Image render(const FrameSettings& settings);

    /// One sample in two steps, for lobes that the caller traces between them (drawFrame in
    /// gl/traced_frame.h). First all that the display pass reads, and the surfaces to be traced, for
    /// which it waits for the GPU unless `reflections` is lookup. A sample may be left unfinished.
    PendingSample beginSample(const FrameSettings& settings, Reflections reflections, PictureSum& sum);
    /// Then the display pass, which adds the sample to `sum`. pre: nothing has been drawn or changed since
    /// beginSample.
    void finishSample(const PendingSample& sample, const TracedIncident& incident, PictureSum& sum);

    /// lastFrameTimes() counts from the next sample on. draw() and render() call it.
    void restartTimes();
    /// Waits for the GPU.
    FrameTimes lastFrameTimes() const;
    /// Reflection rays that the GPU traced for the same samples; those toward emitters do not count. Waits
    /// for the GPU.
    uint64_t lastFrameRays() const;
    /// Texels that the GPU reads to trace the reflections of a frame of one sample: see
    /// lib/count_fetches.glsl.
    uint64_t countRayFetches(FrameSettings settings);
    /// On the GPU, for one PHATexel of the indirect light: itself, and all that the lookup reads beside it. 0
    /// where nothing can be looked up.
    double bytesPerPhatexel() const;
    ResidentBytes residentBytes() const;

    /// Materials may change between frames (roughness, colour ...); textures stay. Shadow maps are drawn
    /// again when an opacity is another one.
    void setMaterials(const std::vector<Material>& materials);
    /// Punctual lights may change too; their direct light follows, the bake's indirect light does not. Shadow
    /// maps are drawn again when a light is another one.
    void setLights(const std::vector<PunctualLight>& lights);
    /// Rotates the environment behind the scene, see turned(); the light that it sent into the scene stays
    /// baked.
    void turnEnvironment(int columns);

    /// Everything is where it is in `scene` now, which has the triangles of the one that was uploaded;
    /// shadows follow at the next frame. `points`: of the same scene. All three replace
    /// RendererInput's and must stay until the next call. `worldFromRest`: as SceneState has it.
    void moveScene(const Scene& scene, const Atlas& atlas, const TexelPoints& points,
                   std::span<const glm::mat4> worldFromRest);
    /// Takes over parts of a bake that were updated, for at most about `seconds`. Tile patches go first,
    /// because moveScene has moved what is there already; a block's tiles are never parted. What is done is
    /// taken out of `update`; returns whether all is.
    bool takeUpdate(LightUpdate& update, double seconds);

    /// Light is made by the GPU from now on (gl/light_update_pass.h). `rest`: as the constructor was given
    /// it, also where things have been moved since. pre: with trees for rays. Throws GlError for PHATexels
    /// that cannot be looked up.
    void beginLight(const RendererInput& rest);
    /// Traces the rays of a round. Irradiance is shown by the next filterLight(). Returns, where the round
    /// compares, for each of its blocks what BlockOrder::noteCheck asks for.
    std::vector<float> traceLight(const LightRound& round);
    void filterLight();
    /// Nothing bounds what lobes receive, from a change of the light to the next boundLight().
    void unboundLight();
    /// By the PHATexels that there are now.
    void boundLight();
    void waitForLight();
    /// Waits for the GPU.
    StoredLight readLight() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Scene-linear to display-linear [0,1]; exposure in stops. twin: shaders/lib/tone_map.glsl.
Image toneMap(const Image& image, ToneMap operation, float exposureStops);

}  // namespace phat
