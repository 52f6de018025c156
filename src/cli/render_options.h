#pragma once
// Options of `phat render`.

#include <optional>
#include <string>
#include <vector>

#include "core/render/phat_gather.h"
#include "core/render/photon_renderer.h"
#include "core/render/picture.h"
#include "gl/renderer.h"
#include "io/phat/scene_lighting.h"

namespace phat {

/// A rendering method.
struct RenderMethod {
    const char* name;
    bool traced = false;        // on the CPU, by rays; else drawn by OpenGL
    bool needsBake = true;      // a scene that is not baked is baked first
    int samplesPerPixel = 4;    // unless told
    bool readsPhotons = false;  // of a photon map made for the picture
};

inline constexpr RenderMethod kRenderMethods[] = {
    {"phat"},
    {"phat-pyramid"},
    {"phat-paper"},
    {.name = "phat-gather", .traced = true, .samplesPerPixel = 1},
    {.name = "photons-direct", .traced = true, .needsBake = false, .readsPhotons = true},
    {.name = "photons-gather",
     .traced = true,
     .needsBake = false,
     .samplesPerPixel = 1,
     .readsPhotons = true},
    {.name = "path", .traced = true, .needsBake = false, .samplesPerPixel = 64},
};

/// Frames of an animation, and the budget of dynamic lighting between them.
struct AnimatedFrames {
    double start = 0, end = 0;  // seconds of the animation
    double perSecond = 24;
    double workPerFrame = 0;     // see IncrementalBaker::advance; or
    double secondsPerFrame = 0;  // of all cores
    std::string animation;       // name or index; empty: the first
};

/// Where reflection rays are traced.
enum class Tracer : uint8_t {
    automatic,  // see prefersGpuRays
    gpu,
    cpu,
};

struct RenderOptions {
    RenderMethod method = kRenderMethods[0];
    std::string input;
    std::string output;
    std::string varianceOutput;  // traced methods; empty: none
    std::string pixels;          // mask of those to trace; empty: all
    SceneLighting lighting;
    std::string variant;  // of a scene that is not baked; empty: none
    std::string camera;   // name, index or kAllCameras; empty: the first
    std::optional<glm::vec3> eye, target;
    std::optional<float> fovDegrees;
    int width = 960;
    int height = 0;  // 0: from the camera's aspect
    int samplesPerPixel = 4;
    Quality quality = Quality::standard;  // phat
    bool countReads = false;              // phat
    double seconds = 0;                   // traced methods; > 0: instead of samplesPerPixel
    PixelFilter filter = PixelFilter::box;
    uint64_t seed = 1;
    std::optional<int> threads;
    uint64_t photons = PhotonSettings().count;         // photons-direct, photons-gather
    PhotonRendererSettings photonRenderer;             // the same
    PhatGatherSettings gather;                         // phat-gather
    Reflections reflections = Reflections::automatic;  // phat
    Tracer tracer = Tracer::automatic;                 // phat
    bool follow = false;                               // phat: see FrameSettings::followsLast
    Component component = Component::all;
    std::optional<AnimatedFrames> animated;  // phat
    int refinements = 0;                     // phat: how often its light is made anew and averaged
    std::vector<std::string> things;         // files that are drawn beside the bake
    std::vector<std::string> edits;
    bool keepLight = false;              // methods without a bake: the edits are for the eye alone
    std::optional<float> exposureStops;  // none: the picture's own
    ToneMap toneMap = ToneMap::agx;
    bool quiet = false;
    bool json = false;
};

}  // namespace phat
