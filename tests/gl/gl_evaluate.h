#pragma once
// Runs GLSL expressions on the GPU over rows of numbers, to compare them with their C++ twins.

#include <array>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "gl/shader_loader.h"

namespace phat::test {

inline const std::string kShaderFolder = PHAT_SOURCE_DIR "/shaders";

/// Atlas::unitMeters of what is evaluated.
inline constexpr float kEvaluatedUnitMeters = 0.7f;

/// Evaluates `body` for each row. It sees `vec4 a, b, c, d` (a row's inputs), and writes `vec4 result`;
/// `include` is the library file under test. `splitSum` binds core's table to splitSumTable; `bind`
/// sets what else there is, from texture unit 3 on.
std::vector<glm::vec4> evaluateGlsl(const std::string& include, const std::string& body,
                                    const std::vector<std::array<glm::vec4, 4>>& rows, GlslFlavor flavor,
                                    GLuint splitSum = 0, GLuint guidePdf = 0,
                                    const std::function<void(GLuint program)>& bind = {});

}  // namespace phat::test
