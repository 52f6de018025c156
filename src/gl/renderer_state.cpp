#include "gl/renderer_state.h"

#include <algorithm>

#include "core/scene/light_bound.h"
#include "gl/textures.h"

namespace phat {
namespace {

bool anyBlended(const std::vector<Material>& materials) {
    return std::any_of(materials.begin(), materials.end(),
                       [](const Material& m) { return m.alphaMode == AlphaMode::blend; });
}

}  // namespace

bool anyClearcoat(const std::vector<Material>& materials) {
    return std::any_of(materials.begin(), materials.end(), [](const Material& m) { return m.clearcoat > 0; });
}

bool Renderer::State::previews(const FrameSettings& settings, bool traced) {
    if (!settings.mayPreview || settings.inspection.what != Inspected::nothing) return false;
    if (!std::exchange(hasPreviewed, true)) return true;
    bool ready = isReady(displayFor(settings.method == Method::phatPaper, false));
    if (lookup.guideCount > 0) ready &= isReady(lookupFor(false));
    if (traced) ready &= reflections().program.isReady();
    return !ready;
}

Renderer::State::Prepared Renderer::State::prepare(const FrameSettings& settings, bool traced, bool preview) {
    const Inspected what = settings.inspection.what;
    const bool lookedUp = settings.method == Method::phat, paper = settings.method == Method::phatPaper;
    const bool counting = lookedUp && what == Inspected::reads;
    const CommonPass& commons = commonPass();
    const LookupPass* lookups = !preview && lookup.guideCount > 0 ? &lookupFor(counting) : nullptr;
    const ReflectionPass* tracedPass = !preview && traced ? &reflections() : nullptr;
    const bool rays = !preview && lookups && settings.tracedByGpu != Reflections::lookup;
    const RayPass* rayTracingPass = rays ? &rayTracing() : nullptr;
    const DisplayPass* displayPass = preview ? nullptr : &displayFor(paper, counting);
    const glm::uvec2 size = sizeOf(settings);
    if (targets.size != size || (lookups && !targets.lookup.incident) ||
        (tracedPass && !targets.reflections.target) || (rays && !targets.rays.points)) {
        targets = createFrameTargets(size, lookups, traced, rayTracingPass);
        rayHistory.valid = false;
    }
    if (!preview)
        completeGlassTargets(targets.glass, size, glassNeeds({materials, glass}, traced, rays),
                             anyClearcoat(materials));
    if (rays && !glass.empty())
        addPaneTargets(targets.rays, targets.lookup, targets.glass.depth.name(), targets.glass.paneLight);

    // A query needs a complete framebuffer; a context without a window has none of its own.
    glBindFramebuffer(GL_FRAMEBUFFER, targets.pictureTarget.name());
    if (std::exchange(clockRestarts, false)) {
        clock.restart();
        rayCounter.restart();
    }
    glDisable(GL_BLEND);
    currentShadows();
    const RelightPass* pyramid = nullptr;
    if (!preview && (!lookedUp || anyBlended(materials) || !glass.empty()))
        pyramid = &pyramidFrom(eyeOf(settings.camera), paper);
    const bool texelsShown = what != Inspected::nothing && what != Inspected::reads;
    filterTextures(scene, settings.filter);
    if (added) filterTextures(added->scene, settings.filter);
    return {commons,
            {scene,
             atlas,
             shadows,
             lookup,
             {materials, glass},
             displayPass,
             pyramid,
             lookups,
             tracedPass,
             rayTracingPass,
             rays ? &currentRayScene() : nullptr,
             rays ? &rayHistory : nullptr,
             rays ? &rayCounter : nullptr,
             texelsShown ? &inspecting() : nullptr,
             clock,
             environmentTurn,
             added ? &*added : nullptr,
             added ? &adding() : nullptr}};
}

FrameSettings Renderer::State::possible(FrameSettings settings) {
    const Inspected what = settings.inspection.what;
    // The views of the pyramid are of ours, not of the paper's.
    if (what == Inspected::reads)
        settings.method = Method::phat;
    else if (what != Inspected::nothing)
        settings.method = Method::phatPyramid;
    if (settings.method == Method::phat && lookup.guideCount == 0) settings.method = Method::phatPyramid;
    if (settings.method != Method::phat || what != Inspected::nothing || !restBvh)
        settings.tracedByGpu = Reflections::lookup;
    // A window does not wait for the rays' programs.
    if (settings.tracedByGpu != Reflections::lookup && settings.mayPreview && !isReady(rayTracing()))
        settings.tracedByGpu = Reflections::lookup;
    return settings;
}

void Renderer::State::show(const Scene& now, const Atlas& itsAtlas, const TexelPoints& points) {
    shownScene = &now;
    shownAtlas = &itsAtlas;
    shownPoints = &points;
}

void Renderer::State::findGlass() {
    glass = glassOfSurfaces(*shownScene, materials);
}

void Renderer::State::texelsChanged() {
    for (auto* made : {&relit, &relitPaper})
        if (*made) (*made)->materialsChanged = true;
}

void Renderer::State::dropPasses() {
    relit.reset(), relitPaper.reset();
    lookupPass.reset(), countingLookupPass.reset();
    reflectionPass.reset(), rayPass.reset(), countingRayPass.reset();
    display.reset(), displayPaper.reset(), countingDisplay.reset();
    addedProgram.reset();
    targets = {};
}

const LookupPass& Renderer::State::lookupFor(bool counting) {
    std::optional<LookupPass>& made = counting ? countingLookupPass : lookupPass;
    if (!made) made = createLookupPass(shaderFolder, lookup, anyClearcoat(materials), counting);
    return *made;
}

const ShadowMaps& Renderer::State::currentShadows() {
    if (!shadows.depth) {
        drawShadows(commonPass().shadows);
        clock.ended(Pass::shadows);
    }
    return shadows;
}

const CommonPass& Renderer::State::commonPass() {
    const bool glassAppears = common && !glass.empty() && common->shadows.tints.name() == 0;
    if (!common || glassAppears) common = createCommonPass(shaderFolder, atlas, !glass.empty());
    return *common;
}

const DisplayPass& Renderer::State::displayFor(bool paper, bool counting) {
    std::optional<DisplayPass>& made = paper ? displayPaper : counting ? countingDisplay : display;
    const bool glassAppears = made && !glass.empty() && made->glass.display.name() == 0;
    if (!made || glassAppears)
        made = createDisplayPass(shaderFolder, atlas,
                                 {.clearcoat = anyClearcoat(materials),
                                  .glass = !glass.empty(),
                                  .discs = hasDisc(lights),
                                  .paper = paper,
                                  .countReads = counting});
    return *made;
}

Renderer::State::Relit& Renderer::State::relitFor(bool paper) {
    std::optional<Relit>& made = paper ? relitPaper : relit;
    if (!made) made = Relit{createRelightPass(shaderFolder, atlas, anyClearcoat(materials), paper), true, {}};
    return *made;
}

const GpuTexelSurfaces& Renderer::State::currentSurfaces() {
    if (!surfaces)
        surfaces = uploadTexelSurfaces(*shownScene, *shownAtlas, *shownPoints);
    else if (surfacesTurned)
        updateNormals(*surfaces, *shownScene, *shownAtlas, *shownPoints);
    surfacesTurned = false;
    return *surfaces;
}

const RelightPass& Renderer::State::pyramidFrom(const Eye& eye, bool paper) {
    Relit& of = relitFor(paper);
    if (!of.materialsChanged && eye.position == of.eye.position && eye.atInfinity == of.eye.atInfinity)
        return of.pass;
    const GpuTexelSurfaces& under = currentSurfaces();
    clock.ended(Pass::none);  // the CPU's work
    if (of.materialsChanged) applyMaterials(of.pass, atlas, under, materials);
    phat::relight(of.pass, atlas, under, scene.splitSum.name(), eye);
    clock.ended(Pass::relight);
    buildPyramid(of.pass, atlas);
    clock.ended(Pass::pyramid);
    of.materialsChanged = false;
    of.eye = eye;
    return of.pass;
}

const ReflectionPass& Renderer::State::reflections() {
    if (!reflectionPass) reflectionPass = createReflectionPass(shaderFolder, anyClearcoat(materials));
    return *reflectionPass;
}

const GpuRayScene& Renderer::State::currentRayScene() {
    if (!rayScene || raysEdited) {
        // The scene keeps the materials that it was read with.
        Scene now = *shownScene;
        now.materials = materials;
        if (!rayScene) {
            rayScene.emplace(
                GpuRayScene{uploadBvh(now, *restBvh), uploadHits(now, *shownAtlas, *restBvh), {}});
            raysMoved = true;
        } else {
            updateOpacity(rayScene->bvh, now, *restBvh);
            updateHits(rayScene->hits, now, *shownAtlas, *restBvh);
        }
        rayScene->brightest = brightestRadiance(now);
    }
    if (raysMoved) moveBvh(rayScene->bvh, poseBvh(*restBvh, worldFromRest));
    if (raysMoved || raysEdited) rayHistory.valid = false;
    raysMoved = raysEdited = false;
    return *rayScene;
}

const RayPass& Renderer::State::rayTracing() {
    std::optional<RayPass>& made = countsFetches ? countingRayPass : rayPass;
    const bool glassAppears = made && !glass.empty() && !made->glass;
    if (!made || glassAppears)
        made = createRayPass(
            shaderFolder, lookupFor(false), lookup,
            {bvhDefines(*restBvh), !glass.empty(), bool(scene.environment.picture), countsFetches});
    return *made;
}

void Renderer::State::drawShadows(const ShadowPrograms& programs) {
    std::vector<ShadowCasters> casters = {{scene, {materials, glass}}};
    if (added) casters.push_back({added->scene, added->drawn()});
    shadows = renderShadowMaps(lights, casters, programs);
}

const ShaderProgram& Renderer::State::adding() {
    if (!addedProgram)
        addedProgram.emplace(createAddedProgram(shaderFolder, hasDisc(lights), !glass.empty()));
    return *addedProgram;
}

const ShaderProgram& Renderer::State::inspecting() {
    if (!inspectProgram) inspectProgram.emplace(shaderFolder, "surface.vert", "inspect.frag");
    return *inspectProgram;
}

}  // namespace phat
