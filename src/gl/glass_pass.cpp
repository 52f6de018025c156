#include "gl/glass_pass.h"

#include <algorithm>
#include <bit>

#include "core/scene/brdf.h"
#include "gl/draw_order.h"
#include "gl/textures.h"

namespace phat {
namespace {

// The picture behind rough glass is taken anew for so many of the nearest rough surfaces, which show those
// behind them; all others show what was drawn before the farthest of them.
constexpr int kMaxPictures = 4;

bool isRough(const Material& material) {
    return square(material.roughness) > kMinAlpha;
}

// Which of the surfaces to be drawn need a new picture of what is behind them.
std::vector<bool> picturesBefore(const std::vector<uint32_t>& order, const DisplayInput& input) {
    std::vector<size_t> rough;
    for (size_t i = 0; i < order.size(); ++i) {
        const DrawRange& draw = input.scene.drawRanges[order[i]];
        if (input.materials.glassOf(draw) != Glass::none && isRough(input.materials.of(draw)))
            rough.push_back(i);
    }
    std::vector<bool> before(order.size());
    for (size_t i = 0; i < rough.size(); ++i) before[rough[i]] = i == 0 || i + kMaxPictures > rough.size();
    return before;
}

void beginBlending(const DisplayInput& input, const OpaquePicture& opaque) {
    glBindFramebuffer(GL_FRAMEBUFFER, opaque.target.name());
    glViewport(0, 0, GLsizei(opaque.size.x), GLsizei(opaque.size.y));
    glBindVertexArray(input.scene.vertexArray.name());
    glEnable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_FALSE);
    glEnable(GL_CULL_FACE);
}

void takePictureBehind(const BlendedDrawing& drawing, const CameraMatrices& matrices,
                       const OpaquePicture& opaque, const Camera& camera) {
    glDisable(GL_BLEND);
    const ShaderProgram& program = drawing.glass.behind.program;
    program.bind("picture", 0, opaque.picture.name());
    program.bind("depth", 1, opaque.depth.name());
    program.set("worldFromClip", glm::inverse(matrices.clipFromWorld));
    program.set("viewport", glm::vec2(opaque.size));
    bindCamera(program, matrices, camera);
    drawing.glass.behind.draw(drawing.targets.behindTarget, opaque.size);
    glGenerateTextureMipmap(drawing.targets.behind.name());
}

void bindGlass(const BlendedDrawing& drawing, const PendingSample& sample, bool scatters) {
    const ShaderProgram& program = drawing.glass.display;
    program.set("tracesPanes", int(!sample.panes.empty() || drawing.tracedByGpu));
    program.set("scatters", int(scatters));
    // The R2 sequence [Roberts 2018].
    program.set("turn", glm::fract(float(sample.view.frame) * glm::vec2(0.7548777f, 0.5698403f)));
    // Also where they are empty: samplers of several kinds must not share a unit.
    program.bind("panes", kPanesUnit, drawing.targets.depth.name());
    program.bind("paneLight", kPaneLightUnit, drawing.targets.paneLight.name());
    program.bind("behind", kBehindUnit, drawing.targets.behind.name());
}

}  // namespace

GlassNeeds glassNeeds(const DrawnMaterials& materials, bool tracedByCpu, bool tracedByGpu) {
    if (materials.glass.empty()) return {};
    const bool rough = std::any_of(materials.materials.begin(), materials.materials.end(),
                                   [](const Material& m) { return isGlass(m) && isRough(m); });
    return {tracedByCpu || tracedByGpu, tracedByCpu, rough};
}

void completeGlassTargets(GlassTargets& targets, glm::uvec2 size, const GlassNeeds& needs, bool clearcoat) {
    if (needs.panes && !targets.depth) {
        targets.depth = createTexture2D(GL_DEPTH_COMPONENT32F, size);
        targets.paneLight = createTextureArray(GL_RGBA32UI, size, clearcoat ? 4 : 2);
    }
    if (needs.byCpu && !targets.panes.target)
        targets.panes = createReflectionTargets(size, targets.depth.name());
    if (needs.behind && !targets.behind) {
        targets.behind = createTexture2D(GL_RGBA32F, size, int(std::bit_width(std::max(size.x, size.y))));
        glTextureParameteri(targets.behind.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
        glTextureParameteri(targets.behind.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        targets.behindTarget = createFramebuffer({{targets.behind.name()}});
    }
    checkGl("creating the targets of glass");
}

GlassPass createGlassPass(const std::string& folder, std::vector<std::string> defines, bool textures) {
    GlassPass pass;
    defines.push_back("GLASS");
    if (textures) defines.push_back("GLASS_TEXTURES");
    pass.display = ShaderProgram(folder, "surface.vert", "display.frag", defines);
    pass.behind = FullscreenProgram(folder, "behind.frag");
    pass.textures = textures;
    return pass;
}

void drawPanes(const ShaderProgram& program, const DisplayInput& input, const OpaquePicture& opaque,
               const GlassTargets& targets) {
    glCopyImageSubData(opaque.depth.name(), GL_TEXTURE_2D, 0, 0, 0, 0, targets.depth.name(), GL_TEXTURE_2D, 0,
                       0, 0, 0, GLsizei(opaque.size.x), GLsizei(opaque.size.y), 1);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glBindVertexArray(input.scene.vertexArray.name());
    program.use();
    for (const DrawRange& draw : input.scene.drawRanges) {
        if (input.materials.glassOf(draw) == Glass::none) continue;
        setCulling(input.materials.of(draw));
        drawSurface(program, input, draw);
    }
    glDepthMask(GL_FALSE);
}

void findPanes(const DisplayInput& input, const CameraMatrices& matrices, const OpaquePicture& opaque,
               const GlassTargets& targets, PendingSample& sample) {
    const ShaderProgram& program = input.reflectionPass->program;
    beginReflections(*input.reflectionPass, input.atlas, input.lookup, targets.panes, sample.reflections,
                     sample.view.frame);
    bindCamera(program, matrices, sample.settings.camera);
    drawPanes(program, input, opaque, targets);
    sample.panes = readTracedSurfaces(targets.panes, sample.jitter);
}

void uploadPanes(const DisplayInput& input, const GlassTargets& targets, const PendingSample& sample,
                 const TracedIncident& incident) {
    uploadReflections(*input.reflectionPass, targets.panes, sample.panes, incident.panes,
                      targets.paneLight.name(), 0);
}

void drawBlended(const BlendedDrawing& drawing, const DisplayInput& input, const CameraMatrices& matrices,
                 const OpaquePicture& opaque, const PendingSample& sample) {
    const FrameSettings& settings = sample.settings;
    const std::vector<uint32_t> order = farToNear(input.scene.drawRanges, input.materials, settings.camera);
    if (order.empty()) return;
    const bool scatters = drawing.glass.textures && drawing.targets.behind;
    if (!input.materials.glass.empty()) {
        bindShared(drawing.glass.display, input, matrices, settings, nullptr);
        bindGlass(drawing, sample, scatters);
    }
    bindShared(drawing.blended, input, matrices, settings, nullptr);
    const std::vector<bool> pictureBefore = picturesBefore(order, input);
    beginBlending(input, opaque);
    for (size_t i = 0; i < order.size(); ++i) {
        if (scatters && pictureBefore[i]) {
            takePictureBehind(drawing, matrices, opaque, settings.camera);
            // It is drawn with units that the display program has in common with it.
            bindShared(drawing.glass.display, input, matrices, settings, nullptr);
            beginBlending(input, opaque);
        }
        const DrawRange& draw = input.scene.drawRanges[order[i]];
        const Glass glass = input.materials.glassOf(draw);
        const ShaderProgram& program = glass == Glass::none ? drawing.blended : drawing.glass.display;
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

}  // namespace phat
