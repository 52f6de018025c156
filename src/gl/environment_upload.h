#pragma once
// The environment on the GPU, and the tables by which shaders choose directions of it.

#include <vector>

#include "core/scene/scene.h"
#include "gl/gl_objects.h"
#include "gl/shader_loader.h"

namespace phat {

struct GpuEnvironment {
    GlTexture picture;    // RGBA32F, see shaders/lib/environment.glsl; empty without an environment
    GlTexture choices;    // see shaders/lib/environment_samples.glsl; empty where nothing is sampled
    glm::ivec2 cells{0};  // columns, rows
    int cellTexels = 1;   // a cell's side
    // kSkyPoints directions chosen by them with their density, 1/sr, and the mean radiance of their cells.
    std::vector<glm::vec4> points, pointRadiance;
    GlSampler sampler;
};

/// twin: shaders/lib/sky_at_hits.glsl.
inline constexpr int kSkyPoints = 32;

/// Throws GlError. pre: the picture is not empty.
GpuEnvironment uploadEnvironment(const Environment& environment);

/// What lib/environment.glsl reads, but for its turn.
void bindEnvironment(const GpuEnvironment& gpu, const ShaderProgram& program, int unit);
/// What lib/sky_at_hits.glsl reads of it. `turn`: of the environment, in turns.
void setSkyPoints(const GpuEnvironment& gpu, const ShaderProgram& program, float turn);
/// What lib/environment_samples.glsl reads, to `firstUnit` and the next one.
void bindEnvironmentSamples(const GpuEnvironment& gpu, const ShaderProgram& program, int firstUnit);

}  // namespace phat
