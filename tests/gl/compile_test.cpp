// Every shader compiles for the desktop and for the browser, and stays within what every GPU has.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "gl/gl_context.h"
#include "gl/gl_error.h"
#include "gl/gl_evaluate.h"
#include "gl/programs.h"

namespace phat::test {
namespace {

std::vector<std::vector<std::string>> variants() {
    return {{},
            {"AREA"},
            {"CLEARCOAT"},
            {"AREA", "CLEARCOAT"},
            {"TEXEL_PDF"},
            {"LOOKUP", "AREA", "CLEARCOAT"},
            {"LOOKUP", "SUN_DISC"},
            {"SCRAMBLES", "CLEARCOAT"},
            {"PAPER", "AREA", "CLEARCOAT"},
            {"BVH_OPACITY", "ANY_HIT"},
            {"TRACED", "AREA", "CLEARCOAT"}};
}

TEST(Shaders, CompileInBothFlavors) {
    const HeadlessContext context;
    if (!epoxy_has_gl_extension("GL_ARB_ES3_compatibility")) GTEST_SKIP() << "no GL_ARB_ES3_compatibility";
    int compiled = 0;
    for (const auto& entry : std::filesystem::directory_iterator(kShaderFolder)) {
        const std::string extension = entry.path().extension();
        if (extension != ".vert" && extension != ".frag") continue;
        for (GlslFlavor flavor : {GlslFlavor::desktop, GlslFlavor::web}) {
            for (const auto& defines : variants()) {
                const std::string name = entry.path().filename();
                EXPECT_NO_THROW(compileShader(extension == ".vert" ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER,
                                              assembleShader(kShaderFolder, name, flavor, defines)))
                    << name;
                ++compiled;
            }
        }
    }
    EXPECT_GE(compiled, 10 * 2 * int(variants().size()));
}

// WebGL 2 and OpenGL ES 3 promise 16 texture units a stage.
TEST(Shaders, UseAtMostSixteenSamplers) {
    const HeadlessContext context;
    int most = 0;
    for (const auto& [vertex, fragment, defines] : longestPrograms()) {
        // These are made where there are more units.
        const auto has = [&](const char* define) {
            return std::find(defines.begin(), defines.end(), define) != defines.end();
        };
        if (has("GLASS_TEXTURES") || has("SUN_DISC") || has("SHADOW_TINTS")) continue;
        const ShaderProgram program(kShaderFolder, vertex, fragment, defines);
        program.use();
        GLint uniforms = 0;
        glGetProgramiv(program.name(), GL_ACTIVE_UNIFORMS, &uniforms);
        const std::set<GLenum> kinds = {GL_SAMPLER_2D, GL_SAMPLER_2D_ARRAY, GL_SAMPLER_2D_ARRAY_SHADOW,
                                        GL_UNSIGNED_INT_SAMPLER_2D, GL_UNSIGNED_INT_SAMPLER_2D_ARRAY};
        int samplers = 0;
        for (GLint i = 0; i < uniforms; ++i) {
            GLint size = 0;
            GLenum type = 0;
            GLchar name[128];
            glGetActiveUniform(program.name(), GLuint(i), sizeof(name), nullptr, &size, &type, name);
            samplers += kinds.count(type) ? size : 0;
        }
        EXPECT_LE(samplers, 16) << fragment;
        most = std::max(most, samplers);
    }
    EXPECT_GE(most, 15);
}

TEST(Shaders, MissingFileAndBadSourceAreOneSentence) {
    const HeadlessContext context;
    EXPECT_THROW(assembleShader(kShaderFolder, "no_such.frag", GlslFlavor::desktop), GlError);
    ShaderSource broken = assembleShader(kShaderFolder, "pyramid.frag", GlslFlavor::desktop);
    broken.text += "\nvoid broken() { return 1 +; }\n";
    try {
        compileShader(GL_FRAGMENT_SHADER, broken);
        FAIL() << "compiled";
    } catch (const GlError& error) {
        EXPECT_NE(std::string(error.what()).find("pyramid.frag"), std::string::npos) << error.what();
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
}

TEST(Shaders, ReadsOfTheConeAreAsDocumented) {
    const HeadlessContext context;
    // A row is (center.xy, radius): counts the taps that coneSum would visit if all were of the chart.
    std::vector<std::array<glm::vec4, 4>> rows;
    for (int i = 0; i < 2000; ++i) {
        const float t = float(i) / 2000.0f;
        rows.push_back({glm::vec4(100 + 8 * t, 50 + 13 * t * t, 1 + 23 * t, 0)});
    }
    const auto results = evaluateGlsl("lib/cone.glsl", R"(
        int level = coneLevel(a.z);
        ivec4 taps = coneTaps(a.xy, a.z, level);
        result = vec4(float((taps.z - taps.x + 1) * (taps.w - taps.y + 1)), float(kMaxTaps), float(level), 0.0);)",
                                      rows, GlslFlavor::desktop);
    float most = 0;
    for (const glm::vec4& r : results) {
        most = std::max(most, r.x);
        ASSERT_LE(r.x, r.y);
        ASSERT_LE(r.z, 3.0f);
    }
    EXPECT_GE(most, 36.0f);
}

}  // namespace
}  // namespace phat::test
