#pragma once
// What shaders/lib/sample_numbers.glsl reads.

#include "gl/shader_loader.h"

namespace phat {

/// twin: kMaxSamples in shaders/lib/sample_numbers.glsl.
inline constexpr uint32_t kMaxSamples = 32;

/// Sobol's points, of which the pixels of a group of 4x4 have aligned runs of `count`, at most kMaxSamples;
/// each seed shifts them all.
void setSampleNumbers(const ShaderProgram& program, uint32_t count, uint32_t seed);

}  // namespace phat
