#include "gl/display_pass.h"

#include "gl/added_pass.h"
#include "gl/camera_matrices.h"
#include "gl/draw_order.h"
#include "gl/inspect_pass.h"
#include "gl/textures.h"

namespace phat {
namespace {

// Measured: see notes/experiments.md, "Lookup".
LookupSampling samplingOf(Quality quality) {
    constexpr LookupSampling kSampling[] = {{2, 2}, {8, 4}, {32, 4}};
    return kSampling[size_t(quality)];
}

void drawBackground(const CommonPass& pass, const DisplayInput& input, const CameraMatrices& camera,
                    glm::uvec2 size, bool shown) {
    const GLfloat black[4] = {0, 0, 0, 0};
    glClearBufferfv(GL_COLOR, 0, black);
    const GLfloat farthest = 0;
    glDepthMask(GL_TRUE);
    glClearBufferfv(GL_DEPTH, 0, &farthest);
    if (!shown || !input.scene.environment.picture) return;
    const ShaderProgram& program = pass.background.program;
    bindEnvironment(input.scene.environment, program, 0);
    program.set("worldFromClip", camera.worldFromClipRotation);
    program.set("viewport", glm::vec2(size));
    program.set("turn", input.environmentTurn);
    pass.background.draw();
}

// Of the opaque surfaces of a scene.
void drawDepths(const ShaderProgram& program, const GpuScene& scene, const DrawnMaterials& materials) {
    glBindVertexArray(scene.vertexArray.name());
    for (const DrawRange& draw : scene.drawRanges) {
        const Material& material = materials.of(draw);
        if (isSeenThrough(materials, draw)) continue;
        setCulling(material);
        program.set("alphaMode", int(material.alphaMode));
        bindMaterial(scene, program, material, 0, BoundSlots::baseColor);
        glDrawArrays(GL_TRIANGLES, draw.firstVertex, draw.vertexCount);
    }
}

void drawDepth(const CommonPass& pass, const DisplayInput& input, const CameraMatrices& camera) {
    const ShaderProgram& program = pass.shadows.depth;
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    program.set("clipFromWorld", camera.clipFromWorld);
    program.use();
    if (input.added && !input.inspectProgram) drawDepths(program, input.added->scene, input.added->drawn());
    drawDepths(program, input.scene, input.materials);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

CameraMatrices cameraOf(const DisplayInput& input, const FrameTargets& targets, const PendingSample& sample) {
    Bounds bounds = input.scene.bounds;
    if (input.added && !input.added->scene.bounds.empty()) {
        bounds.add(input.added->scene.bounds.low);
        bounds.add(input.added->scene.bounds.high);
    }
    return matricesOf(sample.settings.camera, targets.size, bounds, sample.jitter);
}

RayFrame rayFrameOf(const DisplayInput& input, const CameraMatrices& camera, const FrameTargets& targets,
                    const PendingSample& sample) {
    const FrameSettings& settings = sample.settings;
    const float pixels = float(targets.size.y);
    return {*input.rayScene,
            input.atlas,
            input.lookup,
            input.scene,
            input.shadows,
            targets.lookup,
            camera.clipFromWorld,
            eyeOf(settings.camera),
            settings.camera.perspective ? settings.camera.yfovRadians / pixels : 0.0f,
            input.environmentTurn,
            settings.seed + sample.view.frame,
            settings.rays,
            *input.rayHistory,
            *input.rayCounter,
            input.clock,
            settings.followsLast};
}

OpaquePicture opaquePictureOf(const FrameTargets& targets) {
    return {targets.size, targets.picture, targets.depth, targets.pictureTarget};
}

bool tracesPanesByGpu(const DisplayInput& input) {
    return input.rayPass && !input.materials.glass.empty() && input.display->glass.textures;
}

// Glossy light by reflection rays: of all lobes, then of those of the nearest glass.
void traceRays(const DisplayInput& input, const CameraMatrices& camera, const FrameTargets& targets,
               const PendingSample& sample) {
    RayFrame rays = rayFrameOf(input, camera, targets, sample);
    const ShaderProgram& program = input.rayPass->lobes;
    beginTracedLobes(*input.rayPass, targets.rays, rays);
    bindCamera(program, camera, sample.settings.camera);
    drawOpaque(program, input);
    input.clock.ended(Pass::lobes);
    traceLobes(*input.rayPass, targets.rays, rays);
    if (!tracesPanesByGpu(input)) return;
    rays.ofPanes = true;
    beginTracedLobes(*input.rayPass, targets.rays, rays);
    drawPanes(program, input, opaquePictureOf(targets), targets.glass);
    input.clock.ended(Pass::lobes);
    traceLobes(*input.rayPass, targets.rays, rays);
}

// Glossy light of PHATexels.
void lookUp(const DisplayInput& input, const CameraMatrices& camera, const FrameTargets& targets,
            const PendingSample& sample) {
    const FrameSettings& settings = sample.settings;
    const ShaderProgram &lobes = input.lookupPass->lobesProgram, &program = input.lookupPass->lookupProgram;
    beginLobes(targets.lookup);
    bindCamera(lobes, camera, settings.camera);
    drawOpaque(lobes, input);
    input.clock.ended(Pass::lobes);
    beginLookup(*input.lookupPass, input.atlas, input.lookup, targets.lookup, samplingOf(settings.quality),
                sample.view.frame);
    bindCamera(program, camera, settings.camera);
    drawOpaqueShapes(program, input);
    input.clock.ended(Pass::lookup);
    poolSums(*input.lookupPass, targets.lookup);
    input.clock.ended(Pass::pool);
}

// Draws and reads the surfaces whose lobes are traced.
void findTracedSurfaces(const DisplayInput& input, const CameraMatrices& camera, const FrameTargets& targets,
                        PendingSample& sample) {
    if (sample.reflections == Reflections::lookup || !(sample.view.area || sample.view.indirect)) return;
    const ShaderProgram& program = input.reflectionPass->program;
    beginReflections(*input.reflectionPass, input.atlas, input.lookup, targets.reflections,
                     sample.reflections, sample.view.frame);
    bindCamera(program, camera, sample.settings.camera);
    drawOpaque(program, input);
    sample.surfaces = readTracedSurfaces(targets.reflections, sample.jitter);
    if (!input.materials.glass.empty() && input.display->glass.textures)
        findPanes(input, camera, opaquePictureOf(targets), targets.glass, sample);
    input.clock.ended(Pass::display);
}

void drawInspection(const DisplayInput& input, const CameraMatrices& camera, const FrameSettings& settings) {
    const ShaderProgram& program = *input.inspectProgram;
    bindInspection(program, input.atlas, *input.relit, settings.inspection);
    bindCamera(program, camera, settings.camera);
    drawOpaque(program, input);
}

}  // namespace

FrameTargets createFrameTargets(glm::uvec2 size, const LookupPass* lookup, bool traced, const RayPass* rays) {
    FrameTargets targets;
    targets.size = size;
    targets.picture = createTexture2D(GL_RGBA32F, size);
    targets.depth = createTexture2D(GL_DEPTH_COMPONENT32F, size);
    targets.pictureTarget = createFramebuffer({{targets.picture.name()}}, targets.depth.name());
    if (lookup) targets.lookup = createLookupTargets(*lookup, size, targets.depth.name(), traced || rays);
    if (lookup && rays) targets.rays = createRayTargets(*lookup, targets.lookup, targets.depth.name());
    if (lookup && traced) targets.reflections = createReflectionTargets(size, targets.depth.name());
    checkGl("creating the frame's targets");
    return targets;
}

CommonPass createCommonPass(const std::string& folder, const GpuAtlas& atlas, bool glass) {
    CommonPass pass;
    std::vector<std::string> defines;
    if (atlas.sources.size() > 1) defines.push_back("AREA");
    pass.preview = ShaderProgram(folder, "surface.vert", "preview.frag", defines);
    pass.shadows.depth = ShaderProgram(folder, "surface.vert", "depth.frag");
    if (glass) pass.shadows.tints = ShaderProgram(folder, "surface.vert", "shadow_tint.frag");
    pass.background = FullscreenProgram(folder, "background.frag");
    pass.accumulate = FullscreenProgram(folder, "accumulate.frag");
    return pass;
}

DisplayPass createDisplayPass(const std::string& folder, const GpuAtlas& atlas,
                              const DisplayFeatures& features) {
    std::vector<std::string> defines;
    if (atlas.sources.size() > 1) defines.push_back("AREA");
    if (features.clearcoat) defines.push_back("CLEARCOAT");
    // Where the units do not suffice, glass is without its own textures, casts no shadows, is sharp, and its
    // reflections are not traced, and a sun's shadows are hard.
    GLint units = 0;
    glGetIntegerv(GL_MAX_TEXTURE_IMAGE_UNITS, &units);
    const bool shadowTints = features.glass && units >= kGlassUnits;
    if (shadowTints) defines.push_back("SHADOW_TINTS");
    if (features.discs && units > kDepthUnit) defines.push_back("SUN_DISC");
    DisplayPass pass;
    const auto display = [&](std::vector<std::string> indirect) {
        indirect.insert(indirect.end(), defines.begin(), defines.end());
        return ShaderProgram(folder, "surface.vert", "display.frag", indirect);
    };
    pass.displayProgram = features.paper ? display({"PAPER"}) : display({});
    pass.lookedUpProgram = features.countReads ? display({"LOOKUP", "COUNT_READS"}) : display({"LOOKUP"});
    if (features.glass) {
        std::vector<std::string> ofGlass = defines;
        if (features.paper) ofGlass.push_back("PAPER");
        pass.glass = createGlassPass(folder, std::move(ofGlass), shadowTints);
    }
    return pass;
}

bool isReady(const DisplayPass& pass) {
    return pass.displayProgram.isReady() && pass.lookedUpProgram.isReady() && pass.glass.display.isReady() &&
           pass.glass.behind.program.isReady();
}

void prepareSample(const CommonPass& pass, const DisplayInput& input, const FrameTargets& targets,
                   PendingSample& sample) {
    const ReversedDepth reversed;
    const FrameSettings& settings = sample.settings;
    const CameraMatrices camera = cameraOf(input, targets, sample);
    glBindFramebuffer(GL_FRAMEBUFFER, targets.pictureTarget.name());
    glViewport(0, 0, GLsizei(targets.size.x), GLsizei(targets.size.y));
    glDisable(GL_BLEND);
    const bool sky = settings.inspection.what == Inspected::nothing && shownParts(settings.component).x > 0;
    drawBackground(pass, input, camera, targets.size, sky);

    glBindVertexArray(input.scene.vertexArray.name());
    drawDepth(pass, input, camera);
    input.clock.ended(Pass::depth);
    if (sample.preview || input.inspectProgram || settings.method != Method::phat) return;
    glDepthMask(GL_FALSE);  // clearing the targets must leave the depth
    if (input.rayPass)
        traceRays(input, camera, targets, sample);
    else
        lookUp(input, camera, targets, sample);
    findTracedSurfaces(input, camera, targets, sample);
}

void displaySample(const CommonPass& pass, const DisplayInput& input, const FrameTargets& targets,
                   const PendingSample& sample, const TracedIncident& incident) {
    const ReversedDepth reversed;
    const FrameSettings& settings = sample.settings;
    const CameraMatrices camera = cameraOf(input, targets, sample);
    const bool traced = !sample.surfaces.empty();
    if (traced)
        uploadReflections(*input.reflectionPass, targets.reflections, sample.surfaces, incident.surfaces,
                          targets.lookup.incident.name(), lookedUpLayers(*input.lookupPass));
    if (!sample.panes.empty()) uploadPanes(input, targets.glass, sample, incident);
    if (traced || !sample.panes.empty()) input.clock.ended(Pass::none);  // with the rays
    glBindFramebuffer(GL_FRAMEBUFFER, targets.pictureTarget.name());
    glViewport(0, 0, GLsizei(targets.size.x), GLsizei(targets.size.y));
    if (sample.preview) {
        bindDiffuse(pass.preview, input, camera, settings);
        drawOpaque(pass.preview, input);
        if (input.added) drawAddedOpaque(input, camera, settings);
    } else if (input.inspectProgram) {
        drawInspection(input, camera, settings);
    } else {
        const DisplayPass& display = *input.display;
        const LookupTargets* looked = settings.method == Method::phat ? &targets.lookup : nullptr;
        const ShaderProgram& program = looked ? display.lookedUpProgram : display.displayProgram;
        bindShared(program, input, camera, settings, looked, traced || input.rayPass);
        drawOpaque(program, input);
        if (input.added) drawAddedOpaque(input, camera, settings);
        drawBlended({display.displayProgram, display.glass, targets.glass, tracesPanesByGpu(input)}, input,
                    camera, opaquePictureOf(targets), sample);
        if (input.added) drawAddedBlended(input, camera, settings);
    }
    glDepthMask(GL_TRUE);
    input.clock.ended(Pass::display);
}

void addSample(const CommonPass& pass, const FrameTargets& targets, PictureSum& sum) {
    if (sum.samples == 0) {
        glBindFramebuffer(GL_FRAMEBUFFER, sum.target.name());
        const GLfloat black[4] = {0, 0, 0, 0};
        glClearBufferfv(GL_COLOR, 0, black);
    }
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    pass.accumulate.program.bind("picture", 0, targets.picture.name());
    pass.accumulate.draw(sum.target, sum.size);
    glDisable(GL_BLEND);
    ++sum.samples;
}

}  // namespace phat
