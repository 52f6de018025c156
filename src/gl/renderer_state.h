#pragma once
// What a Renderer keeps between frames.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gl/display_pass.h"
#include "gl/phatexture_upload.h"
#include "gl/renderer.h"

namespace phat {

struct Renderer::State {
    /// The relit PHATexels and what they were relit for.
    struct Relit {
        RelightPass pass;
        bool materialsChanged = true;
        Eye eye;
    };
    /// What the passes of a picture read.
    struct Prepared {
        const DisplayPass& pass;
        DisplayInput input;
    };

    /// Makes what a sample needs and is missing, targets of `size` included. `settings`: as possible()
    /// returns them; `traced`: with surfaces whose lobes are traced.
    Prepared prepare(const FrameSettings& settings, bool traced);
    /// What of the settings this bake can show.
    FrameSettings possible(FrameSettings settings) const;
    /// The surfaces are those of `now`, for what is made of them later.
    void show(const Scene& now, const Atlas& itsAtlas, const TexelPoints& points);
    /// What the pyramids are made of has changed.
    void texelsChanged();
    /// A clear coat changes what the shaders are made of.
    void dropPasses();

    const LookupPass& lookupFor(bool counting);
    const DisplayPass& displayFor(bool paper, bool counting);

    std::string shaderFolder;
    // The scene as it is now, for what is made of it later.
    const Scene* shownScene = nullptr;
    const Atlas* shownAtlas = nullptr;
    const TexelPoints* shownPoints = nullptr;
    std::vector<Material> materials;
    std::vector<PunctualLight> lights;
    float environmentTurn = 0;
    int environmentWidth = 1;
    GpuScene scene;
    GpuAtlas atlas;
    GpuLookup lookup;
    ShadowMaps shadows;  // empty: to be drawn again
    FrameTargets targets;
    PassClock clock;
    bool clockRestarts = true;  // at the next sample
    double bytesPerPhatexel = 0;

    // Made when they are first needed: compiling takes a while, and so do the texels' surfaces.
    std::optional<GpuTexelSurfaces> surfaces;
    bool surfacesTurned = false;
    std::optional<Relit> relit, relitPaper;
    std::optional<LookupPass> lookupPass, countingLookupPass;
    std::optional<ReflectionPass> reflectionPass;
    std::optional<DisplayPass> display, displayPaper, countingDisplay;
    std::optional<ShaderProgram> inspectProgram;

  private:
    Relit& relitFor(bool paper);
    const GpuTexelSurfaces& currentSurfaces();
    /// The pyramid as it is seen from `eye`.
    const RelightPass& pyramidFrom(const Eye& eye, bool paper);
    const ReflectionPass& reflections();
    const ShaderProgram& inspecting();
};

bool anyClearcoat(const std::vector<Material>& materials);

}  // namespace phat
