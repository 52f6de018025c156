#include "gl/surface_drawing.h"

#include "gl/added_pass.h"
#include "gl/draw_order.h"

namespace phat {
namespace {

// `draw`: of a surface, with the state that all opaque surfaces have.
template <class Draw>
void forEachOpaque(const ShaderProgram& program, const DisplayInput& input, const Draw& draw) {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_EQUAL);
    glDepthMask(GL_FALSE);
    glBindVertexArray(input.scene.vertexArray.name());
    program.use();
    for (size_t i = 0; i < input.scene.drawRanges.size(); ++i) {
        const DrawRange& range = input.scene.drawRanges[i];
        if (isSeenThrough(input.materials, range)) continue;
        setCulling(input.materials.of(range));
        program.set("surfaceIndex", int(i));
        draw(range);
    }
}

}  // namespace

void bindCamera(const ShaderProgram& program, const CameraMatrices& matrices, const Camera& camera) {
    program.set("clipFromWorld", matrices.clipFromWorld);
    const Eye eye = eyeOf(camera);
    program.set("eyeWorld", eye.position);
    program.set("eyeAtInfinity", eye.atInfinity ? 1.0f : 0.0f);
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

void bindDiffuse(const ShaderProgram& program, const DisplayInput& input, const CameraMatrices& matrices,
                 const FrameSettings& settings) {
    program.bind("tileTable", 2, input.atlas.tileTable.name());
    program.bind("irradiance", 3, input.atlas.irradiance.name());
    program.bind("lightTable", 5, input.shadows.lightTable.name());
    program.bind("shadowMaps", 6, input.shadows.depth.name());
    program.set("lightCount", input.shadows.lightCount);
    program.set("show", shownParts(settings.component));
    bindCamera(program, matrices, settings.camera);
    const std::span<const glm::vec4> occluders =
        input.added ? std::span(input.added->occluders) : std::span<const glm::vec4>();
    program.set("occluderCount", int(occluders.size() / 3));
    if (!occluders.empty()) program.set("occluders", occluders);
}

void bindShared(const ShaderProgram& program, const DisplayInput& input, const CameraMatrices& matrices,
                const FrameSettings& settings, const LookupTargets* looked, bool traced) {
    if (looked) {
        program.set("tracedLayer", traced ? lookedUpLayers(*input.lookupPass) : 0);
        program.bind("incident", 0, looked->incident.name());
        program.bind("tileLight", 1, input.atlas.tileLight.name());
    } else {
        program.bind("relit", 0, input.relit->lobes.name());
        program.bind("radii", 1, input.relit->radii.name());
    }
    program.bind("splitSumTable", 4, input.scene.splitSum.name());
    bindDiffuse(program, input, matrices, settings);
    if (input.shadows.tints) program.bind("shadowTints", kTintUnit, input.shadows.tints.name());
    if (input.shadows.depthValues) program.bind("shadowDepths", kDepthUnit, input.shadows.depthValues.name());
    program.use();
}

void setCulling(const Material& material) {
    if (material.doubleSided) {
        glDisable(GL_CULL_FACE);
    } else {
        glEnable(GL_CULL_FACE);
        glCullFace(GL_BACK);
    }
}

void drawSurface(const ShaderProgram& program, const DisplayInput& input, const DrawRange& draw) {
    const Material& material = input.materials.of(draw);
    const bool glass = input.materials.glassOf(draw) != Glass::none;
    program.set("alphaMode", int(material.alphaMode));
    bindMaterial(input.scene, program, material, kFirstMaterialUnit,
                 glass ? BoundSlots::glass : BoundSlots::opaque, draw.metersPerUnit);
    glDrawArrays(GL_TRIANGLES, draw.firstVertex, draw.vertexCount);
}

void drawOpaque(const ShaderProgram& program, const DisplayInput& input) {
    forEachOpaque(program, input, [&](const DrawRange& draw) { drawSurface(program, input, draw); });
}

void drawOpaqueShapes(const ShaderProgram& program, const DisplayInput& input) {
    forEachOpaque(program, input, [](const DrawRange& draw) {
        glDrawArrays(GL_TRIANGLES, draw.firstVertex, draw.vertexCount);
    });
}

}  // namespace phat
