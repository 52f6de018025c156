#include "gl/display_pass.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "core/base/random.h"
#include "gl/draw_order.h"
#include "gl/inspect_pass.h"
#include "gl/material_table.h"
#include "gl/textures.h"

namespace phat {
namespace {

// Texture units 0-6 are common to all materials, 7-15 a material's nine slots: the 16 that every GPU has.
constexpr int kFirstMaterialUnit = 7;
// And more where there is glass: its own slots, and the shadows that it casts. Most GPUs have 32.
constexpr int kTintUnit = kFirstMaterialUnit + kSlotCount, kGlassUnits = kTintUnit + 1;

struct CameraMatrices {
    glm::mat4 clipFromWorld{1};
    glm::mat4 worldFromClipRotation{1};  // with the eye at the origin
};

// The picture's shape, not the camera's: a view of another shape shows more or less to the sides,
// undistorted. `jitter` in pixels.
CameraMatrices matricesOf(const Camera& camera, glm::uvec2 size, const Bounds& bounds, glm::vec2 jitter) {
    const float aspect = float(size.x) / float(size.y);
    const glm::vec3 eye(camera.worldFromCamera[3]);
    const float reach = glm::distance(eye, bounds.center()) + 0.5f * bounds.diagonal();
    // Depth loses what the near plane gains: a camera without one has it at a thousandth of the reach.
    const float least = camera.perspective && !(camera.znear > 0) ? 1e-3f : 1e-6f;
    const float nearMeters = std::max(camera.znear, least * reach);
    const float farMeters = std::max(2 * nearMeters, 1.01f * reach);
    glm::mat4 clipFromCamera = camera.perspective
                                   ? glm::perspective(camera.yfovRadians, aspect, nearMeters, farMeters)
                                   : glm::ortho(-camera.ymag * aspect, camera.ymag * aspect, -camera.ymag,
                                                camera.ymag, nearMeters, farMeters);
    const glm::vec2 shift = 2.0f * jitter / glm::vec2(size);
    clipFromCamera = glm::translate(glm::mat4(1), glm::vec3(shift, 0)) * clipFromCamera;
    const glm::mat4 cameraFromWorld = glm::inverse(camera.worldFromCamera);
    return {clipFromCamera * cameraFromWorld,
            glm::inverse(clipFromCamera * glm::mat4(glm::mat3(cameraFromWorld)))};
}

// Measured: see notes/experiments.md, "Lookup".
LookupSampling samplingOf(Quality quality) {
    constexpr LookupSampling kSampling[] = {{2, 2}, {8, 4}, {32, 4}};
    return kSampling[size_t(quality)];
}

void setCulling(const Material& material) {
    if (material.doubleSided) {
        glDisable(GL_CULL_FACE);
    } else {
        glEnable(GL_CULL_FACE);
        glCullFace(GL_BACK);
    }
}

void drawBackground(const DisplayPass& pass, const DisplayInput& input, const CameraMatrices& camera,
                    glm::uvec2 size, bool shown) {
    const GLfloat black[4] = {0, 0, 0, 0};
    glClearBufferfv(GL_COLOR, 0, black);
    const GLfloat farthest = 1;
    glDepthMask(GL_TRUE);
    glClearBufferfv(GL_DEPTH, 0, &farthest);
    if (!shown || !input.scene.environment) return;
    const ShaderProgram& program = pass.background.program;
    program.bind("environment", 0, input.scene.environment.name(), input.scene.environmentSampler.name());
    program.set("worldFromClip", camera.worldFromClipRotation);
    program.set("viewport", glm::vec2(size));
    program.set("turn", input.environmentTurn);
    pass.background.draw();
}

void drawDepth(const DisplayPass& pass, const DisplayInput& input, const CameraMatrices& camera) {
    const ShaderProgram& program = pass.shadows.depth;
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    program.set("clipFromWorld", camera.clipFromWorld);
    program.use();
    for (const DrawRange& draw : input.scene.drawRanges) {
        const Material& material = input.materials.of(draw);
        if (isSeenThrough(input.materials, draw)) continue;
        setCulling(material);
        program.set("alphaMode", int(material.alphaMode));
        bindMaterial(input.scene, program, material, 0, BoundSlots::baseColor);
        glDrawArrays(GL_TRIANGLES, draw.firstVertex, draw.vertexCount);
    }
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void bindCamera(const ShaderProgram& program, const CameraMatrices& camera, const FrameSettings& settings) {
    program.set("clipFromWorld", camera.clipFromWorld);
    const Eye eye = eyeOf(settings.camera);
    program.set("eyeWorld", eye.position);
    program.set("eyeAtInfinity", eye.atInfinity ? 1.0f : 0.0f);
}

// A display program's tables, and where its glossy light is: pictures that were looked up, or the pyramid.
void bindShared(const ShaderProgram& program, const DisplayInput& input, const CameraMatrices& camera,
                const FrameSettings& settings, const LookupTargets* looked, bool traced = false) {
    if (looked) {
        program.set("tracedLayer", traced ? lookedUpLayers(*input.lookupPass) : 0);
        program.bind("incident", 0, looked->incident.name());
        program.bind("tileLight", 1, input.atlas.tileLight.name());
    } else {
        program.bind("relit", 0, input.relit->lobes.name());
        program.bind("radii", 1, input.relit->radii.name());
    }
    program.bind("tileTable", 2, input.atlas.tileTable.name());
    program.bind("irradiance", 3, input.atlas.irradiance.name());
    program.bind("splitSumTable", 4, input.scene.splitSum.name());
    program.bind("lightTable", 5, input.shadows.lightTable.name());
    program.bind("shadowMaps", 6, input.shadows.depth.name());
    if (input.shadows.tints) program.bind("shadowTints", kTintUnit, input.shadows.tints.name());
    program.set("lightCount", input.shadows.lightCount);
    program.set("show", shownParts(settings.component));
    bindCamera(program, camera, settings);
    program.use();
}

void drawSurface(const ShaderProgram& program, const DisplayInput& input, const DrawRange& draw) {
    const Material& material = input.materials.of(draw);
    const bool glass = input.materials.glassOf(draw) != Glass::none;
    program.set("alphaMode", int(material.alphaMode));
    bindMaterial(input.scene, program, material, kFirstMaterialUnit,
                 glass ? BoundSlots::glass : BoundSlots::opaque);
    glDrawArrays(GL_TRIANGLES, draw.firstVertex, draw.vertexCount);
}

// Blended surfaces and glass over what was drawn already: back to front; a surface's own back before its
// front. Glass multiplies what is behind it by its transmittance in colour. Of a volume only the front is
// drawn, with the light of both of its sides.
void drawBlended(const DisplayPass& pass, const DisplayInput& input, const CameraMatrices& matrices,
                 const FrameSettings& settings) {
    const std::vector<uint32_t> order = farToNear(input.scene.drawRanges, input.materials, settings.camera);
    if (order.empty()) return;
    if (!input.materials.glass.empty()) bindShared(pass.glassProgram, input, matrices, settings, nullptr);
    bindShared(pass.displayProgram, input, matrices, settings, nullptr);
    glEnable(GL_BLEND);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_FALSE);
    glEnable(GL_CULL_FACE);
    for (uint32_t i : order) {
        const DrawRange& draw = input.scene.drawRanges[i];
        const Glass glass = input.materials.glassOf(draw);
        const ShaderProgram& program = glass == Glass::none ? pass.displayProgram : pass.glassProgram;
        if (glass != Glass::none) program.set("glassInterfaces", int(glass));
        program.use();
        glBlendFunc(GL_ONE, glass == Glass::none ? GL_ONE_MINUS_SRC_ALPHA : GL_SRC1_COLOR);
        if (input.materials.of(draw).doubleSided && glass != Glass::volume) {
            glCullFace(GL_FRONT);
            drawSurface(program, input, draw);
        }
        glCullFace(GL_BACK);
        drawSurface(program, input, draw);
    }
    glDisable(GL_BLEND);
}

void drawOpaque(const ShaderProgram& program, const DisplayInput& input) {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_EQUAL);
    glDepthMask(GL_FALSE);
    glBindVertexArray(input.scene.vertexArray.name());
    program.use();
    for (size_t i = 0; i < input.scene.drawRanges.size(); ++i) {
        const DrawRange& draw = input.scene.drawRanges[i];
        if (isSeenThrough(input.materials, draw)) continue;
        setCulling(input.materials.of(draw));
        program.set("surfaceIndex", int(i));
        drawSurface(program, input, draw);
    }
}

void lookUp(const DisplayInput& input, const CameraMatrices& camera, const FrameSettings& settings,
            const LookupTargets& targets, uint32_t seed) {
    const ShaderProgram& program = input.lookupPass->lookupProgram;
    beginLookup(*input.lookupPass, input.atlas, input.lookup, targets, samplingOf(settings.quality), seed);
    bindCamera(program, camera, settings);
    drawOpaque(program, input);
    input.clock.ended(Pass::lookup);
    poolSums(*input.lookupPass, targets);
    input.clock.ended(Pass::pool);
}

// Draws and reads the surfaces whose lobes are traced.
void findTracedSurfaces(const DisplayInput& input, const CameraMatrices& camera, const FrameTargets& targets,
                        PendingSample& sample) {
    if (sample.reflections == Reflections::lookup || !(sample.view.area || sample.view.indirect)) return;
    const ShaderProgram& program = input.reflectionPass->program;
    beginReflections(*input.reflectionPass, input.atlas, input.lookup, targets.reflections,
                     sample.reflections, sample.view.frame);
    bindCamera(program, camera, sample.settings);
    drawOpaque(program, input);
    input.clock.ended(Pass::display);
    sample.surfaces = readTracedSurfaces(targets.reflections, sample.jitter);
}

void drawInspection(const DisplayInput& input, const CameraMatrices& camera, const FrameSettings& settings) {
    const ShaderProgram& program = *input.inspectProgram;
    bindInspection(program, input.atlas, *input.relit, settings.inspection);
    bindCamera(program, camera, settings);
    drawOpaque(program, input);
}

}  // namespace

FrameTargets createFrameTargets(glm::uvec2 size, const LookupPass* lookup, bool traced) {
    FrameTargets targets;
    targets.size = size;
    targets.picture = createTexture2D(GL_RGBA32F, size);
    targets.depth = createTexture2D(GL_DEPTH_COMPONENT32F, size);
    targets.pictureTarget = createFramebuffer({{targets.picture.name()}}, targets.depth.name());
    if (lookup) targets.lookup = createLookupTargets(*lookup, size, targets.depth.name(), traced);
    if (lookup && traced) targets.reflections = createReflectionTargets(size, targets.depth.name());
    checkGl("creating the frame's targets");
    return targets;
}

DisplayPass createDisplayPass(const std::string& folder, const GpuAtlas& atlas, bool clearcoat, bool glass,
                              bool paper, bool countReads) {
    std::vector<std::string> defines;
    if (atlas.sources.size() > 1) defines.push_back("AREA");
    if (clearcoat) defines.push_back("CLEARCOAT");
    // Where the units do not suffice, glass is without its own textures and casts no shadows.
    GLint units = 0;
    glGetIntegerv(GL_MAX_TEXTURE_IMAGE_UNITS, &units);
    const bool shadowTints = glass && units >= kGlassUnits;
    if (shadowTints) defines.push_back("SHADOW_TINTS");
    DisplayPass pass;
    const auto display = [&](std::vector<std::string> indirect) {
        indirect.insert(indirect.end(), defines.begin(), defines.end());
        return ShaderProgram(folder, "surface.vert", "display.frag", indirect);
    };
    pass.displayProgram = paper ? display({"PAPER"}) : display({});
    pass.lookedUpProgram = countReads ? display({"LOOKUP", "COUNT_READS"}) : display({"LOOKUP"});
    if (glass) {
        std::vector<std::string> ofGlass{"GLASS"};
        if (paper) ofGlass.push_back("PAPER");
        if (shadowTints) ofGlass.push_back("GLASS_TEXTURES");
        pass.glassProgram = display(std::move(ofGlass));
        pass.shadows.tints = ShaderProgram(folder, "surface.vert", "shadow_tint.frag");
    }
    pass.shadows.depth = ShaderProgram(folder, "surface.vert", "depth.frag");
    pass.background = FullscreenProgram(folder, "background.frag");
    pass.accumulate = FullscreenProgram(folder, "accumulate.frag");
    return pass;
}

void prepareSample(const DisplayPass& pass, const DisplayInput& input, const FrameTargets& targets,
                   PendingSample& sample) {
    const FrameSettings& settings = sample.settings;
    const CameraMatrices camera =
        matricesOf(settings.camera, targets.size, input.scene.bounds, sample.jitter);
    glBindFramebuffer(GL_FRAMEBUFFER, targets.pictureTarget.name());
    glViewport(0, 0, GLsizei(targets.size.x), GLsizei(targets.size.y));
    glDisable(GL_BLEND);
    const bool sky = settings.inspection.what == Inspected::nothing && shownParts(settings.component).x > 0;
    drawBackground(pass, input, camera, targets.size, sky);

    glBindVertexArray(input.scene.vertexArray.name());
    drawDepth(pass, input, camera);
    input.clock.ended(Pass::depth);
    if (input.inspectProgram || settings.method != Method::phat) return;
    glDepthMask(GL_FALSE);  // clearing the targets must leave the depth
    lookUp(input, camera, settings, targets.lookup, sample.view.frame);
    findTracedSurfaces(input, camera, targets, sample);
}

void displaySample(const DisplayPass& pass, const DisplayInput& input, const FrameTargets& targets,
                   const PendingSample& sample, std::span<const SurfaceIncident> incident) {
    const FrameSettings& settings = sample.settings;
    const CameraMatrices camera =
        matricesOf(settings.camera, targets.size, input.scene.bounds, sample.jitter);
    const bool traced = !sample.surfaces.empty();
    if (traced) {
        uploadReflections(*input.reflectionPass, targets.reflections, sample.surfaces, incident,
                          targets.lookup.incident.name(), lookedUpLayers(*input.lookupPass));
        input.clock.ended(Pass::none);  // with the rays
    }
    glBindFramebuffer(GL_FRAMEBUFFER, targets.pictureTarget.name());
    glViewport(0, 0, GLsizei(targets.size.x), GLsizei(targets.size.y));
    if (input.inspectProgram) {
        drawInspection(input, camera, settings);
    } else {
        const LookupTargets* looked = settings.method == Method::phat ? &targets.lookup : nullptr;
        const ShaderProgram& program = looked ? pass.lookedUpProgram : pass.displayProgram;
        bindShared(program, input, camera, settings, looked, traced);
        drawOpaque(program, input);
        drawBlended(pass, input, camera, settings);
    }
    glDepthMask(GL_TRUE);
    input.clock.ended(Pass::display);
}

void addSample(const DisplayPass& pass, const FrameTargets& targets, PictureSum& sum) {
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

// Sobol's first two dimensions [Kollig and Keller 2002 for the second], moved so that the first of many
// points is near the pixel's centre and the mean of a power of two of them is there.
glm::vec2 jitterOf(int index, int count) {
    if (count == 1) return glm::vec2(0);
    uint32_t y = 0;
    for (uint32_t direction = 1u << 31, i = uint32_t(index); i != 0; i >>= 1, direction ^= direction >> 1)
        if (i & 1) y ^= direction;
    const glm::vec2 point = glm::vec2(glm::uvec2(reverseBits(uint32_t(index), 16), y >> 16)) / 65536.0f +
                            0.5f + 0.5f / float(count);
    return glm::fract(point) - 0.5f;
}

glm::vec3 shownParts(Component component) {
    switch (component) {
        case Component::all:
            return {1, 1, 1};
        case Component::direct:
            return {1, 0, 0};
        case Component::indirect:
            return {0, 1, 1};
        case Component::glossyIndirect:
            return {0, 1, 0};
        case Component::diffuseIndirect:
            return {0, 0, 1};
    }
    return glm::vec3(1);
}

Eye eyeOf(const Camera& camera) {
    if (camera.perspective) return {glm::vec3(camera.worldFromCamera[3]), false};
    return {glm::normalize(glm::vec3(camera.worldFromCamera[2])), true};
}

}  // namespace phat
