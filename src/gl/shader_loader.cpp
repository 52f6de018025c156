#include "gl/shader_loader.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "gl/gl_error.h"

namespace phat {
namespace {

const char* preamble(GlslFlavor flavor) {
    if (flavor == GlslFlavor::desktop) return "#version 450 core\n";
    return "#version 300 es\n"
           "precision highp float;\n"
           "precision highp int;\n"
           "precision highp sampler2D;\n"
           "precision highp sampler2DArray;\n"
           "precision highp sampler2DArrayShadow;\n"
           "precision highp usampler2D;\n"
           "precision highp usampler2DArray;\n";
}

void append(ShaderSource& source, const std::string& folder, const std::string& name) {
    if (std::find(source.files.begin(), source.files.end(), name) != source.files.end()) return;
    const size_t fileNumber = source.files.size();
    source.files.push_back(name);

    std::ifstream stream(folder + "/" + name);
    if (!stream) throw GlError(fmt::format("cannot read the shader {}/{}", folder, name));
    source.text += fmt::format("#line 1 {}\n", fileNumber);
    std::string line;
    for (int number = 1; std::getline(stream, line); ++number) {
        if (line.rfind("#include", 0) != 0) {
            source.text += line + '\n';
            continue;
        }
        const size_t open = line.find('"'), close = line.rfind('"');
        if (open == close) throw GlError(fmt::format("{}:{}: #include without a quoted file", name, number));
        append(source, folder, line.substr(open + 1, close - open - 1));
        source.text += fmt::format("#line {} {}\n", number + 1, fileNumber);
    }
}

// Drivers write "0:12(3): error: ..." or "0(12) : error ...": the leading file number becomes its name.
std::string firstError(const std::string& log, const std::vector<std::string>& files) {
    std::istringstream lines(log);
    std::string line;
    while (std::getline(lines, line) && line.find("error") == std::string::npos) {
    }
    size_t digits = 0;
    while (digits < line.size() && std::isdigit(static_cast<unsigned char>(line[digits]))) ++digits;
    if (digits == 0 || digits > 3) return line;
    const size_t file = std::stoul(line.substr(0, digits));
    return file < files.size() ? files[file] + line.substr(digits) : line;
}

std::string logOf(GLuint object, void (*getInteger)(GLuint, GLenum, GLint*),
                  void (*getLog)(GLuint, GLsizei, GLsizei*, GLchar*)) {
    GLint length = 0;
    getInteger(object, GL_INFO_LOG_LENGTH, &length);
    std::string log(size_t(std::max(length, 1)), '\0');
    getLog(object, GLsizei(log.size()), nullptr, log.data());
    return log;
}

GlShader beginCompiling(GLenum stage, const ShaderSource& source) {
    GlShader shader(glCreateShader(stage));
    const char* text = source.text.c_str();
    glShaderSource(shader.name(), 1, &text, nullptr);
    glCompileShader(shader.name());
    return shader;
}

void requireCompiled(const GlShader& shader, const std::vector<std::string>& files) {
    GLint compiled = 0;
    glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
    if (compiled) return;
    const std::string log = logOf(
        shader.name(), [](GLuint o, GLenum e, GLint* v) { glGetShaderiv(o, e, v); },
        [](GLuint o, GLsizei n, GLsizei* l, GLchar* t) { glGetShaderInfoLog(o, n, l, t); });
    throw GlError("the shader does not compile: " + firstError(log, files));
}

}  // namespace

ShaderSource assembleShader(const std::string& folder, const std::string& name, GlslFlavor flavor,
                            const std::vector<std::string>& defines) {
    ShaderSource source;
    source.text = preamble(flavor);
    for (const std::string& define : defines) source.text += "#define " + define + "\n";
    const bool counts = std::find(defines.begin(), defines.end(), "COUNT_FETCHES") != defines.end();
    if (counts && name.ends_with(".frag")) append(source, folder, "lib/count_fetches.glsl");
    append(source, folder, name);
    return source;
}

GlShader compileShader(GLenum stage, const ShaderSource& source) {
    GlShader shader = beginCompiling(stage, source);
    requireCompiled(shader, source.files);
    return shader;
}

bool compilesInBackground() {
    return epoxy_has_gl_extension("GL_KHR_parallel_shader_compile") ||
           epoxy_has_gl_extension("GL_ARB_parallel_shader_compile");
}

struct ShaderProgram::Stages {
    GlShader vertex, fragment;
    std::vector<std::string> vertexFiles, fragmentFiles;
};

ShaderProgram::ShaderProgram() = default;
ShaderProgram::~ShaderProgram() = default;
ShaderProgram::ShaderProgram(ShaderProgram&&) noexcept = default;
ShaderProgram& ShaderProgram::operator=(ShaderProgram&&) noexcept = default;

ShaderProgram::ShaderProgram(const std::string& folder, const std::string& vertexFile,
                             const std::string& fragmentFile, const std::vector<std::string>& defines,
                             GlslFlavor flavor)
    : program_(glCreateProgram()) {
    const ShaderSource vertex = assembleShader(folder, vertexFile, flavor, defines);
    const ShaderSource fragment = assembleShader(folder, fragmentFile, flavor, defines);
    stages_ = std::make_unique<Stages>(Stages{beginCompiling(GL_VERTEX_SHADER, vertex),
                                              beginCompiling(GL_FRAGMENT_SHADER, fragment), vertex.files,
                                              fragment.files});
    glAttachShader(program_.name(), stages_->vertex.name());
    glAttachShader(program_.name(), stages_->fragment.name());
    glLinkProgram(program_.name());
}

bool ShaderProgram::isReady() const {
    if (!stages_ || !compilesInBackground()) return true;
    GLint done = 0;
    glGetProgramiv(name(), GL_COMPLETION_STATUS_KHR, &done);
    return done != 0;
}

void ShaderProgram::use() const {
    finish();
    glUseProgram(program_.name());
}

void ShaderProgram::finish() const {
    if (!stages_) return;
    const std::unique_ptr<Stages> stages = std::move(stages_);
    GLint linked = 0;
    glGetProgramiv(program_.name(), GL_LINK_STATUS, &linked);
    if (!linked) {
        requireCompiled(stages->vertex, stages->vertexFiles);
        requireCompiled(stages->fragment, stages->fragmentFiles);
        const std::string log = logOf(
            program_.name(), [](GLuint o, GLenum e, GLint* v) { glGetProgramiv(o, e, v); },
            [](GLuint o, GLsizei n, GLsizei* l, GLchar* t) { glGetProgramInfoLog(o, n, l, t); });
        throw GlError(fmt::format("{} and {} do not link: {}", stages->vertexFiles[0],
                                  stages->fragmentFiles[0], firstError(log, {})));
    }
    GLint count = 0;
    glGetProgramiv(program_.name(), GL_ACTIVE_UNIFORMS, &count);
    for (GLint i = 0; i < count; ++i) {
        GLchar name[128];
        GLsizei length = 0;
        GLint size = 0;
        GLenum type = 0;
        glGetActiveUniform(program_.name(), GLuint(i), sizeof(name), &length, &size, &type, name);
        std::string key(name, size_t(length));
        const GLint at = glGetUniformLocation(program_.name(), name);
        if (const size_t bracket = key.find('['); bracket != std::string::npos) key.resize(bracket);
        locations_.emplace(key, at);
    }
}

GLint ShaderProgram::location(const char* uniform) const {
    finish();
    const auto found = locations_.find(uniform);
    return found == locations_.end() ? -1 : found->second;
}

void ShaderProgram::set(const char* uniform, int value) const {
    glProgramUniform1i(name(), location(uniform), value);
}
void ShaderProgram::set(const char* uniform, float value) const {
    glProgramUniform1f(name(), location(uniform), value);
}
void ShaderProgram::set(const char* uniform, glm::vec2 value) const {
    glProgramUniform2f(name(), location(uniform), value.x, value.y);
}
void ShaderProgram::set(const char* uniform, glm::ivec2 value) const {
    glProgramUniform2i(name(), location(uniform), value.x, value.y);
}
void ShaderProgram::set(const char* uniform, glm::vec3 value) const {
    glProgramUniform3f(name(), location(uniform), value.x, value.y, value.z);
}
void ShaderProgram::set(const char* uniform, const glm::mat4& value) const {
    glProgramUniformMatrix4fv(name(), location(uniform), 1, GL_FALSE, &value[0][0]);
}
void ShaderProgram::set(const char* uniform, std::span<const glm::vec4> values) const {
    glProgramUniform4fv(name(), location(uniform), GLsizei(values.size()), &values[0][0]);
}
void ShaderProgram::set(const char* uniform, std::span<const glm::uvec4> values) const {
    glProgramUniform4uiv(name(), location(uniform), GLsizei(values.size()), &values[0][0]);
}
void ShaderProgram::bind(const char* uniform, int unit, GLuint texture, GLuint sampler) const {
    glBindTextureUnit(GLuint(unit), texture);
    glBindSampler(GLuint(unit), sampler);
    glProgramUniform1i(name(), location(uniform), unit);
}

}  // namespace phat
