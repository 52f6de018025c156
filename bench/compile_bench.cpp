// How long the driver takes to compile a program, for the first picture waits for some. Run it alone, so that
// the driver has kept nothing: --benchmark_filter=compileProgram.

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "gl/gl_context.h"
#include "gl/programs.h"
#include "gl/shader_loader.h"
#include "gl/textures.h"

namespace phat {
namespace {

using test::ProgramVariant;

// Of all threads: busy neighbours count less.
double processorSeconds() {
    timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

// A texture of the kind that the renderer binds to a sampler of this name: the compiler writes other code for
// others.
GlTexture textureFor(const std::string& sampler, GLenum type) {
    const glm::uvec2 size(16);
    switch (type) {
        case GL_SAMPLER_2D:
            if (sampler.ends_with("Texture")) return createTexture2D(GL_SRGB8_ALPHA8, size, 5);
            if (sampler == "inverseCdfs") return createTexture2D(GL_RGBA8, size);
            return createTexture2D(sampler == "splitSumTable" ? GL_RG32F : GL_RGBA32F, size);
        case GL_SAMPLER_2D_ARRAY:
            return createTextureArray(sampler == "irradiance" ? GL_RGB9_E5 : GL_RGBA32F, size, 2);
        case GL_SAMPLER_2D_ARRAY_SHADOW: {
            GlTexture depth = createTextureArray(GL_DEPTH_COMPONENT32F, size, 2);
            glTextureParameteri(depth.name(), GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
            glTextureParameteri(depth.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
            glTextureParameteri(depth.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
            return depth;
        }
        case GL_UNSIGNED_INT_SAMPLER_2D:
            return createTexture2D(sampler == "scrambles" ? GL_R16UI : GL_RGBA32UI, size);
        case GL_UNSIGNED_INT_SAMPLER_2D_ARRAY:
            return createTextureArray(sampler == "phatexels" ? GL_RG32UI : GL_RGBA32UI, size, 2);
        default:
            return {};
    }
}

// Textures for all samplers of a program, as where a material has all of its own.
std::vector<GlTexture> bindTextures(const ShaderProgram& program, const GlSampler& ofMaterials) {
    std::vector<GlTexture> textures;
    GLint uniforms = 0;
    glGetProgramiv(program.name(), GL_ACTIVE_UNIFORMS, &uniforms);
    for (GLint i = 0; i < uniforms; ++i) {
        GLint size = 0;
        GLenum type = 0;
        GLchar name[128];
        glGetActiveUniform(program.name(), GLuint(i), sizeof(name), nullptr, &size, &type, name);
        GlTexture texture = textureFor(name, type);
        if (!texture) continue;
        const bool filtered = std::string(name).ends_with("Texture");
        program.bind(name, int(textures.size()), texture.name(), filtered ? ofMaterials.name() : 0);
        textures.push_back(std::move(texture));
    }
    return textures;
}

// As many colours as a program may have outputs; those without one are left out by the compiler.
struct Outputs {
    explicit Outputs(const std::string& fragment)
        : floats(createTextureArray(GL_RGBA32F, glm::uvec2(4), 4)),
          integers(createTextureArray(GL_RGBA32UI, glm::uvec2(4), 4)),
          depth(createTexture2D(GL_DEPTH_COMPONENT32F, glm::uvec2(4))) {
        std::vector<Attachment> colors;
        for (int i = 0; i < 4; ++i) {
            const bool integer = fragment == "lookup.frag" || fragment == "pool.frag" ||
                                 (fragment == "traced_surfaces.frag" && i == 2);
            colors.push_back({integer ? integers.name() : floats.name(), 0, i});
        }
        target = createFramebuffer(colors, depth.name());
    }
    GlTexture floats, integers, depth;
    GlFramebuffer target;
};

// Processor time to compile and link a program, and to draw with it for the first time, when llvmpipe
// compiles.
double secondsToCompile(const ProgramVariant& variant) {
    const GlSampler ofMaterials = createSampler(GL_REPEAT, GL_REPEAT, GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR);
    glSamplerParameterf(ofMaterials.name(), GL_TEXTURE_MAX_ANISOTROPY, 8);
    const Outputs outputs(variant.fragment);
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    const GlVertexArray noVertices(name);
    glBindVertexArray(name);
    glBindFramebuffer(GL_FRAMEBUFFER, outputs.target.name());
    glViewport(0, 0, 4, 4);
    const bool surface = std::string(variant.vertex) == "surface.vert";
    surface ? glEnable(GL_DEPTH_TEST) : glDisable(GL_DEPTH_TEST);
    glDepthFunc(GL_EQUAL);
    glFinish();

    double seconds = -processorSeconds();
    const ShaderProgram program(PHAT_SOURCE_DIR "/shaders", variant.vertex, variant.fragment,
                                variant.defines);
    program.use();
    seconds += processorSeconds();
    const std::vector<GlTexture> textures = bindTextures(program, ofMaterials);
    const auto draw = [] {
        const double before = processorSeconds();
        glDrawArrays(GL_TRIANGLES, 0, 3);
        glFinish();
        return processorSeconds() - before;
    };
    const double first = draw(), again = draw();
    checkGl("compiling a program");
    return seconds + first - again;
}

void compileProgram(benchmark::State& state, const ProgramVariant& variant) {
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    const HeadlessContext context;
    for (auto _ : state) state.SetIterationTime(secondsToCompile(variant));
    state.SetLabel(context.rendererName());
}

[[maybe_unused]] const bool registered = [] {
    for (const ProgramVariant& variant : test::longestPrograms()) {
        std::string name = std::string("compileProgram/") + variant.fragment;
        for (const std::string& define : variant.defines) name += ' ' + define;
        benchmark::RegisterBenchmark(name.c_str(), compileProgram, variant)
            ->UseManualTime()
            ->Iterations(1)
            ->Unit(benchmark::kMillisecond);
    }
    return true;
}();

}  // namespace
}  // namespace phat
