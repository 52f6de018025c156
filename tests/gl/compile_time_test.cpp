// No program is so long that it takes long to compile. Where that matters is Mesa's software driver, which
// compiles when a program draws for the first time, while nothing else can be done.

#include <gtest/gtest.h>

#include "gl/gl_context.h"
#include "gl/gl_evaluate.h"
#include "gl/programs.h"

namespace phat::test {
namespace {

// Of what Mesa's compiler makes of a program, all functions inlined. Unlike time it is the same on a busy
// machine. The benchmark compileProgram has the times: with so many bytes and textures in all slots of a
// material they are below two seconds of processor time (notes/experiments.md).
constexpr GLint kMaxBytes = 72'000;

GLint bytesOf(const ProgramVariant& variant) {
    const ShaderProgram program(kShaderFolder, variant.vertex, variant.fragment, variant.defines);
    program.use();
    GLint bytes = 0;
    glGetProgramiv(program.name(), GL_PROGRAM_BINARY_LENGTH, &bytes);
    return bytes;
}

TEST(Shaders, AreShortEnoughToCompileSoon) {
    const HeadlessContext context;
    GLint formats = 0;
    glGetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
    if (formats == 0 || context.rendererName().find("llvmpipe") == std::string::npos)
        GTEST_SKIP() << "not as long as by Mesa: " << context.rendererName();
    GLint most = 0;
    for (const ProgramVariant& variant : longestPrograms()) {
        const GLint bytes = bytesOf(variant);
        std::string name = variant.fragment;
        for (const std::string& define : variant.defines) name += ' ' + define;
        EXPECT_LE(bytes, kMaxBytes) << name;
        most = std::max(most, bytes);
    }
    EXPECT_GE(most, kMaxBytes / 2);  // they are measured
}

// The first picture waits for these.
TEST(Shaders, OfThePreviewAreAFractionOfTheOthers) {
    const HeadlessContext context;
    GLint formats = 0;
    glGetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
    if (formats == 0) GTEST_SKIP() << "no program binaries: " << context.rendererName();
    const GLint preview = bytesOf({"surface.vert", "preview.frag", {"AREA"}});
    const GLint display = bytesOf({"surface.vert", "display.frag", {"LOOKUP", "AREA"}});
    const GLint lookup = bytesOf({"surface.vert", "lookup.frag", {"AREA"}});
    EXPECT_LT(3 * preview, display + lookup);
}

}  // namespace
}  // namespace phat::test
