#pragma once
// Light probes on the GPU.

#include "core/probes/light_probes.h"
#include "gl/gl_objects.h"
#include "gl/shader_loader.h"

namespace phat {

/// Tables that shaders/lib/probe_light.glsl reads.
struct GpuProbes {
    GlTexture cells, light, distances;  // RGBA32UI
    glm::vec3 lowWorld{0}, cellMeters{1}, gridSize{1};
    int texelsPerProbe = 2;
};

/// Of no probes, tables that are dark everywhere. Throws GlError.
GpuProbes uploadProbes(const LightProbes& probes);

/// To units `firstUnit` to `firstUnit` + 2.
void bindProbes(const ShaderProgram& program, const GpuProbes& probes, int firstUnit);

}  // namespace phat
