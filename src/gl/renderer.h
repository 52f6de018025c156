#pragma once
// The OpenGL 4.5 renderer: lookup, or relight and pyramid; then display. source: Hensley et al. 2003, section
// 6; the lookup is ours.
//
// Needs a current context (HeadlessContext, or the viewer's window). Draws what phat render writes and what
// the viewer shows; holds no light transport of its own.

#include <memory>
#include <string>
#include <vector>

#include "core/atlas.h"
#include "core/image.h"
#include "core/phatexture.h"
#include "core/picture.h"
#include "core/scene.h"
#include "core/smooth_reflections.h"

namespace phat {

struct PictureSum;

/// Where indirect light on glossy surfaces comes from.
enum class Method : uint8_t {
    phat,         // looked up by the pixel: draws from the BRDF, answered by PHATexels around
    phatPyramid,  // the paper's passes: the BRDF on every PHATexel, a pyramid, a cone
    phatPaper,    // the same to the letter: no densities, plain means, the paper's filter; diffuse light too
};
/// What the lookup may cost: see docs/pipeline.md for reads a pixel.
enum class Quality : uint8_t { fast, standard, high };
enum class ToneMap : uint8_t { linear, agx, aces };

/// Rays that take the place of the lookup on smooth surfaces. What they read is the caller's, as are its
/// materials.
struct TracedReflections {
    const ReflectionScene& scene;
    Reflections reflections = Reflections::automatic;
    Progress& progress;  // render() throws Interrupted when it asks
};

struct FrameSettings {
    int width = 640;
    int height = 360;
    Camera camera;
    Method method = Method::phat;  // phatPyramid takes its place where directions follow no invertible layout
    Quality quality = Quality::standard;  // of Method::phat
    Component component = Component::all;
    /// Anti-aliasing: this many whole pictures, shifted inside the pixel, are averaged (a box filter of one
    /// pixel, over edges, textures and highlights alike). 1 turns it off.
    int samplesPerPixel = 4;
    /// With `center` they are not shifted: the mean of what frames of a still view show.
    PixelFilter filter = PixelFilter::box;
    /// How many of them one draw() adds; 0: all.
    int samplesPerDraw = 0;
    /// Of Method::phat; null: all reflections are looked up.
    const TracedReflections* traced = nullptr;
};

/// Seconds by pass, on the GPU unless said otherwise.
struct FrameTimes {
    double relight = 0;
    double pyramid = 0;
    double shadows = 0;      // first frame only
    double display = 0;      // with the lookup
    double reflections = 0;  // rays on the CPU
    uint64_t reflectionRays = 0;
};

/// What the renderer needs of a bake. Everything is uploaded in the constructor; the CPU's copies may go.
struct RendererInput {
    const Scene& scene;
    const Atlas& atlas;
    const TexelPoints& points;
    const Phatexture& phatexture;
    /// Pictures of Method::phat hold how many texels were read for a pixel's glossy light: red for indirect light,
    /// green for area lights.
    bool countReads = false;
};

class Renderer {
  public:
    /// `shaderFolder`: where shaders/ is. Throws GlError.
    Renderer(const RendererInput& input, const std::string& shaderFolder);
    ~Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    /// Adds samples to `sum`, which begins anew when its size or its number of samples is not this picture's.
    void draw(const FrameSettings& settings, PictureSum& sum);
    /// The whole picture in linear radiance, row 0 on top. Waits for the GPU.
    Image render(const FrameSettings& settings);
    /// Of the last draw. Waits for the GPU.
    FrameTimes lastFrameTimes() const;
    /// On the GPU, for one PHATexel of the indirect light: itself, and all that the lookup reads beside it. 0
    /// where nothing can be looked up.
    double bytesPerPhatexel() const;

    /// Materials may change between frames (roughness, colour ...); textures stay.
    void setMaterials(const std::vector<Material>& materials);
    /// Punctual lights may change too; their direct light follows, the bake's indirect light does not.
    void setLights(const std::vector<PunctualLight>& lights);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Scene-linear to display-linear [0,1]; exposure in stops. twin: shaders/lib/tone_map.glsl.
Image toneMap(const Image& image, ToneMap operation, float exposureStops);

}  // namespace phat
