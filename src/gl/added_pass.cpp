#include "gl/added_pass.h"

#include "core/scene/occluders.h"
#include "gl/draw_order.h"

namespace phat {
namespace {

constexpr int kFirstProbeUnit = 0;  // where display programs have their glossy light

// An atlas without charts.
Atlas noAtlas(const Scene& scene) {
    Atlas atlas;
    atlas.triangleSurface = scene.triangleSurface;
    atlas.triangleChart.assign(scene.triangles.size(), kNoChart);
    atlas.triangleTexels.resize(scene.triangles.size());
    return atlas;
}

const ShaderProgram& bindAdded(const DisplayInput& input, const CameraMatrices& matrices,
                               const FrameSettings& settings) {
    const ShaderProgram& program = *input.addedProgram;
    bindDiffuse(program, input, matrices, settings);
    program.bind("splitSumTable", 4, input.scene.splitSum.name());
    if (input.shadows.tints) program.bind("shadowTints", kTintUnit, input.shadows.tints.name());
    if (input.shadows.depthValues) program.bind("shadowDepths", kDepthUnit, input.shadows.depthValues.name());
    bindProbes(program, input.added->probes, kFirstProbeUnit);
    glBindVertexArray(input.added->scene.vertexArray.name());
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    program.use();
    return program;
}

void drawOne(const ShaderProgram& program, const GpuAdded& added, const DrawRange& draw) {
    const Material& material = added.materials[draw.material];
    program.set("alphaMode", int(material.alphaMode));
    bindMaterial(added.scene, program, material, kFirstMaterialUnit, BoundSlots::opaque);
    glDrawArrays(GL_TRIANGLES, draw.firstVertex, draw.vertexCount);
}

}  // namespace

GpuAdded uploadAdded(const AddedThings& added) {
    GpuAdded gpu;
    gpu.scene = uploadScene(added.scene, noAtlas(added.scene));
    gpu.materials = added.scene.materials;
    for (Material& material : gpu.materials) material.transmission = 0;
    gpu.probes = uploadProbes(added.probes);
    for (const Occluder& occluder : occludersOf(added.scene))
        for (const glm::vec4& row : rowsOf(occluder)) gpu.occluders.push_back(row);
    return gpu;
}

ShaderProgram createAddedProgram(const std::string& shaderFolder, bool discs, bool glass) {
    GLint units = 0;
    glGetIntegerv(GL_MAX_TEXTURE_IMAGE_UNITS, &units);
    std::vector<std::string> defines;
    if (glass && units > kTintUnit) defines.push_back("SHADOW_TINTS");
    if (discs && units > kDepthUnit) defines.push_back("SUN_DISC");
    return ShaderProgram(shaderFolder, "surface.vert", "added_surface.frag", defines);
}

void drawAddedOpaque(const DisplayInput& input, const CameraMatrices& matrices,
                     const FrameSettings& settings) {
    const GpuAdded& added = *input.added;
    const ShaderProgram& program = bindAdded(input, matrices, settings);
    glDepthFunc(GL_EQUAL);
    for (const DrawRange& draw : added.scene.drawRanges) {
        if (isSeenThrough(added.drawn(), draw)) continue;
        setCulling(added.materials[draw.material]);
        drawOne(program, added, draw);
    }
    glBindVertexArray(input.scene.vertexArray.name());
}

void drawAddedBlended(const DisplayInput& input, const CameraMatrices& matrices,
                      const FrameSettings& settings) {
    const GpuAdded& added = *input.added;
    const std::vector<uint32_t> order = farToNear(added.scene.drawRanges, added.drawn(), settings.camera);
    if (order.empty()) return;
    const ShaderProgram& program = bindAdded(input, matrices, settings);
    glDepthFunc(GL_GREATER);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glEnable(GL_CULL_FACE);
    for (const uint32_t i : order) {
        const DrawRange& draw = added.scene.drawRanges[i];
        if (added.materials[draw.material].doubleSided) {
            glCullFace(GL_FRONT);
            drawOne(program, added, draw);
        }
        glCullFace(GL_BACK);
        drawOne(program, added, draw);
    }
    glDisable(GL_BLEND);
    glBindVertexArray(input.scene.vertexArray.name());
}

}  // namespace phat
