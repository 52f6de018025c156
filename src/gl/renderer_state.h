#pragma once
// State of a Renderer between frames.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gl/added_pass.h"
#include "gl/display_pass.h"
#include "gl/light_update_pass.h"
#include "gl/phatexture_upload.h"
#include "gl/renderer.h"

namespace phat {

struct Renderer::State {
    /// The relit PHATexels and the view that they were relit for.
    struct Relit {
        RelightPass pass;
        bool materialsChanged = true;
        Eye eye;
    };
    /// Input of the passes of a frame.
    struct Prepared {
        const CommonPass& common;
        DisplayInput input;
    };

    /// Creates the missing resources of a sample, targets of its size included. `settings`: as possible()
    /// returns them; `traced`: with surfaces whose lobes are traced; `preview`: of a preview.
    Prepared prepare(const FrameSettings& settings, bool traced, bool preview);
    /// Whether the next sample is a preview. Begins to compile what the whole picture needs, but not with the
    /// first picture, which would wait for it on some drivers.
    bool previews(const FrameSettings& settings, bool traced);
    /// The settings restricted to what this bake supports.
    FrameSettings possible(FrameSettings settings);
    /// The surfaces are those of `now`, for what is made of them later.
    void show(const Scene& now, const Atlas& itsAtlas, const TexelPoints& points);
    /// What is glass, when the surfaces or the materials are other ones.
    void findGlass();
    /// The inputs of the pyramids have changed.
    void texelsChanged();
    /// A clear coat changes the variants of the shaders.
    void dropPasses();

    /// Draws the shadow maps, when lights or things have changed.
    const ShadowMaps& currentShadows();
    /// Where everything is now.
    const GpuRayScene& currentRayScene();

    const CommonPass& commonPass();
    const LookupPass& lookupFor(bool counting);
    const DisplayPass& displayFor(bool paper, bool counting);

    std::string shaderFolder;
    // The present scene, for resources that are created later.
    const Scene* shownScene = nullptr;
    const Atlas* shownAtlas = nullptr;
    const TexelPoints* shownPoints = nullptr;
    std::vector<Material> materials;
    std::vector<Glass> glass;  // [surface] or nothing
    std::vector<PunctualLight> lights;
    float environmentTurn = 0;
    int environmentWidth = 1;
    GpuScene scene;
    std::optional<GpuAdded> added;
    GpuAtlas atlas;
    GpuLookup lookup;
    ShadowMaps shadows;  // empty: to be drawn again
    FrameTargets targets;
    PassClock clock;
    bool clockRestarts = true;  // at the next sample
    bool hasPreviewed = false;
    const SceneBvh* restBvh = nullptr;
    std::vector<glm::mat4> worldFromRest;       // [glTF node]; see SceneState
    bool raysMoved = true, raysEdited = false;  // since the trees, and what rays hit, were brought up to date
    double bytesPerPhatexel = 0;

    // Made when they are first needed: compiling takes a while, and so do the texels' surfaces.
    std::optional<GpuTexelSurfaces> surfaces;
    bool surfacesTurned = false;
    std::optional<Relit> relit, relitPaper;
    std::optional<LookupPass> lookupPass, countingLookupPass;
    std::optional<ReflectionPass> reflectionPass;
    std::optional<GpuRayScene> rayScene;
    std::optional<RayPass> rayPass, countingRayPass;
    bool countsFetches = false;  // in the next frame
    RayHistory rayHistory;
    RayCounter rayCounter;
    std::optional<GpuLight> light;
    std::optional<LightUpdatePass> lightPass;
    std::optional<CommonPass> common;
    std::optional<DisplayPass> display, displayPaper, countingDisplay;
    std::optional<ShaderProgram> inspectProgram, addedProgram;

  private:
    Relit& relitFor(bool paper);
    const GpuTexelSurfaces& currentSurfaces();
    /// The pyramid relit for `eye`.
    const RelightPass& pyramidFrom(const Eye& eye, bool paper);
    const ReflectionPass& reflections();
    const RayPass& rayTracing();
    const ShaderProgram& inspecting();
    const ShaderProgram& adding();
    void drawShadows(const ShadowPrograms& programs);
};

bool anyClearcoat(const std::vector<Material>& materials);

}  // namespace phat
