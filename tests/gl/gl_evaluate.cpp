#include "gl/gl_evaluate.h"

#include "gl/textures.h"

namespace phat::test {

std::vector<glm::vec4> evaluateGlsl(const std::string& include, const std::string& body,
                                    const std::vector<std::array<glm::vec4, 4>>& rows, GlslFlavor flavor,
                                    GLuint splitSum, GLuint guidePdf,
                                    const std::function<void(GLuint program)>& bind) {
    ShaderSource vertex = assembleShader(kShaderFolder, "fullscreen.vert", flavor);
    ShaderSource fragment = assembleShader(kShaderFolder, include, flavor);
    fragment.text +=
        "uniform sampler2D inputs;\n"
        "uniform sampler2D guidePdf;\n"
        "layout(location = 0) out vec4 result;\n"
        "void main() {\n"
        "    int row = int(gl_FragCoord.y);\n"
        "    vec4 a = texelFetch(inputs, ivec2(0, row), 0), b = texelFetch(inputs, ivec2(1, row), 0);\n"
        "    vec4 c = texelFetch(inputs, ivec2(2, row), 0), d = texelFetch(inputs, ivec2(3, row), 0);\n" +
        body + "\n}\n";
    const GlShader vertexShader = compileShader(GL_VERTEX_SHADER, vertex);
    const GlShader fragmentShader = compileShader(GL_FRAGMENT_SHADER, fragment);
    const GlProgram program(glCreateProgram());
    glAttachShader(program.name(), vertexShader.name());
    glAttachShader(program.name(), fragmentShader.name());
    glLinkProgram(program.name());
    glUseProgram(program.name());

    const GLsizei count = GLsizei(rows.size());
    const GlTexture inputs = createTexture2D(GL_RGBA32F, {4, uint32_t(count)});
    glTextureSubImage2D(inputs.name(), 0, 0, 0, 4, count, GL_RGBA, GL_FLOAT, rows.data());
    const GlTexture target = createTexture2D(GL_RGBA32F, {1, uint32_t(count)});
    const GlFramebuffer framebuffer = createFramebuffer({{target.name()}});
    glBindTextureUnit(0, inputs.name());
    glBindTextureUnit(1, splitSum);
    glBindTextureUnit(2, guidePdf);
    glUniform1i(glGetUniformLocation(program.name(), "inputs"), 0);
    glUniform1i(glGetUniformLocation(program.name(), "splitSumTable"), 1);
    glUniform1i(glGetUniformLocation(program.name(), "guidePdf"), 2);
    glUniform1f(glGetUniformLocation(program.name(), "unitMeters"), kEvaluatedUnitMeters);

    if (bind) bind(program.name());

    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    const GlVertexArray noVertices(name);
    glBindVertexArray(name);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    glViewport(0, 0, 1, count);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    std::vector<glm::vec4> results(rows.size());
    glReadPixels(0, 0, 1, count, GL_RGBA, GL_FLOAT, results.data());
    checkGl("evaluating GLSL");
    return results;
}

}  // namespace phat::test
