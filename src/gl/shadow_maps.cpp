#include "gl/shadow_maps.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "core/scene/light_punctual.h"
#include "gl/textures.h"

namespace phat {
namespace {

// Taps reach two texels past a face; with this border they never leave it.
constexpr float kBorderTexels = 3;
// Glass seldom has an edge that is not a frame's, too.
constexpr int kSizeOverTints = 4;
// Cones beyond 60 degrees from their axis waste a single perspective map; they get the six of lights that
// shine all around.
constexpr float kWidestSingleConeCosine = 0.5f;

// Sharp where there are few lights, within 400 MB where there are many.
int mapSize(size_t layers) {
    return layers <= 12 ? 2048 : layers <= 96 ? 1024 : 512;
}

glm::mat4 perspectiveView(glm::vec3 eye, glm::vec3 direction, float tangent, int size, float nearMeters,
                          float farMeters) {
    const float widened = tangent * float(size) / (float(size) - 2 * kBorderTexels);
    const glm::vec3 up = std::abs(direction.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    const glm::mat4 view = glm::lookAt(eye, eye + direction, up);
    return glm::perspective(2 * std::atan(widened), 1.0f, nearMeters, farMeters) * view;
}

// Of a directional light's map, in radii of the scene.
constexpr float kParallelNear = 0.9f, kParallelFar = 3.1f;

glm::mat4 parallelView(glm::vec3 direction, const Bounds& bounds, int size) {
    const float radius = bounds.diagonal() > 0 ? 0.5f * bounds.diagonal() : 1.0f;
    const float half = radius * float(size) / (float(size) - 2 * kBorderTexels);
    const glm::vec3 up = std::abs(direction.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    const glm::mat4 view = glm::lookAt(bounds.center() - 2 * radius * direction, bounds.center(), up);
    return glm::ortho(-half, half, -half, half, kParallelNear * radius, kParallelFar * radius) * view;
}

// Radius in texels of the disc's shadow where caster and receiver are the map's whole depth apart.
float discTexels(const PunctualLight& light, int size) {
    const float texelsPerRadius = 0.5f * (float(size) - 2 * kBorderTexels);
    return std::tan(light.angularRadius) * (kParallelFar - kParallelNear) * texelsPerRadius;
}

int layersOf(const PunctualLight& light) {
    const bool cube =
        light.type != PunctualLight::Type::directional && litCosine(light) < kWidestSingleConeCosine;
    return cube ? 6 : 1;
}

void addViews(const PunctualLight& light, const Bounds& bounds, int size, std::vector<glm::mat4>& views) {
    if (light.type == PunctualLight::Type::directional) {
        views.push_back(parallelView(light.direction, bounds, size));
        return;
    }
    const float reach = glm::distance(light.position, bounds.center()) + 0.5f * bounds.diagonal();
    const float farMeters = reach > 0 ? reach : 1.0f;
    // Geometry nearer than this to a light casts no shadow; float depth keeps the precision beyond.
    const float nearMeters = farMeters * 2e-4f;
    if (layersOf(light) == 1) {
        const float cosine = litCosine(light), tangent = std::sqrt(1 - square(cosine)) / cosine;
        views.push_back(perspectiveView(light.position, light.direction, std::max(tangent, 1e-3f), size,
                                        nearMeters, farMeters));
        return;
    }
    for (int axis = 0; axis < 3; ++axis) {
        for (float sign : {1.0f, -1.0f}) {
            glm::vec3 direction(0);
            direction[axis] = sign;
            views.push_back(perspectiveView(light.position, direction, 1, size, nearMeters, farMeters));
        }
    }
}

GlTexture createDepthArray(int size, int layers) {
    GlTexture depth = createTextureArray(GL_DEPTH_COMPONENT32F, glm::uvec2(size), layers);
    glTextureParameteri(depth.name(), GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTextureParameteri(depth.name(), GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    return depth;
}

// The depths themselves, of the same memory.
GlTexture viewWithoutComparison(const GlTexture& depth, int layers) {
    GLuint name = 0;
    glGenTextures(1, &name);  // a view's name must be of no texture yet
    GlTexture view(name);
    glTextureView(name, GL_TEXTURE_2D_ARRAY, depth.name(), GL_DEPTH_COMPONENT32F, 0, 1, 0, GLuint(layers));
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return view;
}

// Binds a layer to be drawn to while what it returns lives.
GlFramebuffer bindLayer(const GlTexture& texture, GLenum attachment, int layer, int size) {
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    GlFramebuffer framebuffer(name);
    glNamedFramebufferTextureLayer(name, attachment, texture.name(), 0, layer);
    glBindFramebuffer(GL_FRAMEBUFFER, name);
    glViewport(0, 0, size, size);
    const GLfloat one[4] = {1, 1, 1, 1};
    glClearBufferfv(attachment == GL_DEPTH_ATTACHMENT ? GL_DEPTH : GL_COLOR, 0, one);
    return framebuffer;
}

// Opaque and blended surfaces.
void drawDepths(const glm::mat4& clipFromWorld, const ShadowCasters& casters, const ShaderProgram& program) {
    const auto& [gpu, materials] = casters;
    program.set("clipFromWorld", clipFromWorld);
    glBindVertexArray(gpu.vertexArray.name());
    for (const DrawRange& draw : gpu.drawRanges) {
        if (materials.glassOf(draw) != Glass::none) continue;
        const Material& material = materials.of(draw);
        bindMaterial(gpu, program, material, 0, BoundSlots::baseColor);
        program.set("alphaMode", int(material.alphaMode));
        glDrawArrays(GL_TRIANGLES, draw.firstVertex, draw.vertexCount);
    }
}

// The product of what the glass before each other lets through, and the depth of the nearest.
void drawTints(const glm::mat4& clipFromWorld, const ShadowCasters& casters, const ShaderProgram& program) {
    const auto& [gpu, materials] = casters;
    program.set("clipFromWorld", clipFromWorld);
    glBindVertexArray(gpu.vertexArray.name());
    for (const DrawRange& draw : gpu.drawRanges) {
        const Glass glass = materials.glassOf(draw);
        if (glass == Glass::none) continue;
        bindMaterial(gpu, program, materials.of(draw), 0, BoundSlots::baseColor, draw.metersPerUnit);
        program.set("alphaMode", int(materials.of(draw).alphaMode));
        program.set("glassInterfaces", int(glass));
        glDrawArrays(GL_TRIANGLES, draw.firstVertex, draw.vertexCount);
    }
}

GlTexture drawAllTints(const std::vector<PunctualLight>& lights, const std::vector<glm::mat4>& views,
                       int size, std::span<const ShadowCasters> casters, const ShaderProgram& program) {
    GlTexture tints = createTextureArray(GL_RGBA32F, glm::uvec2(size), std::max(1, int(views.size())));
    program.use();
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ZERO, GL_SRC_COLOR);
    glBlendEquationSeparate(GL_FUNC_ADD, GL_MIN);
    size_t view = 0;
    for (const PunctualLight& light : lights)
        for (int i = 0; i < layersOf(light); ++i, ++view) {
            const bool far = light.type == PunctualLight::Type::directional;
            program.set("lightWorld", far ? -light.direction : light.position);
            program.set("lightAtInfinity", far ? 1.0f : 0.0f);
            const GlFramebuffer target = bindLayer(tints, GL_COLOR_ATTACHMENT0, int(view), size);
            for (const ShadowCasters& some : casters) drawTints(views[view], some, program);
        }
    glBlendEquation(GL_FUNC_ADD);
    glDisable(GL_BLEND);
    return tints;
}

// A texel for each cell of a web's grid: its corners, the two of its horizontal angle first.
// twin: texelsOf in web/src/photometric_web.js.
void addPhotometry(const PhotometricWeb& web, std::vector<glm::vec4>& texels) {
    const auto point = [&](int h, int v) {
        return web.relative[size_t(h % web.horizontalSteps) * (web.verticalSteps + 1) + v];
    };
    for (int h = 0; h < web.horizontalSteps; ++h)
        for (int v = 0; v < web.verticalSteps; ++v)
            texels.emplace_back(point(h, v), point(h, v + 1), point(h + 1, v), point(h + 1, v + 1));
}

// The tables of all photometries, which lights may have in common, and the first texel of each light's.
struct PhotometryTables {
    std::vector<glm::vec4> texels;
    std::vector<float> first;  // 0: the light has none
};
PhotometryTables photometryTables(const std::vector<PunctualLight>& lights, size_t texelsBefore) {
    PhotometryTables tables;
    for (size_t i = 0; i < lights.size(); ++i) {
        const SharedValue<Photometry>& own = lights[i].photometry;
        const auto same = std::find_if(lights.begin(), lights.begin() + ptrdiff_t(i),
                                       [&](const PunctualLight& other) { return other.photometry == own; });
        const size_t before = size_t(same - lights.begin());
        if (!own || before < i) {
            tables.first.push_back(own ? tables.first[before] : 0.0f);
            continue;
        }
        tables.first.push_back(float(texelsBefore + tables.texels.size()));
        addPhotometry(own->web(), tables.texels);
    }
    return tables;
}

GlTexture createLightTable(const std::vector<PunctualLight>& lights, const std::vector<glm::mat4>& views,
                           int size, const Bounds& bounds) {
    const float leastSquared = square(kMinLightDistance * 0.5f * bounds.diagonal());
    constexpr size_t kLightRows = 5, kShadowRows = 4;  // twin: shaders/lib/lights.glsl
    const PhotometryTables photometries =
        photometryTables(lights, kLightRows * lights.size() + kShadowRows * views.size());
    std::vector<glm::vec4> rows;
    int layer = 0;
    for (size_t i = 0; i < lights.size(); ++i) {
        const PunctualLight& light = lights[i];
        const PhotometricWeb* web = light.photometry ? &light.photometry->web() : nullptr;
        rows.emplace_back(light.position, float(light.type));
        const bool parallel = light.type == PunctualLight::Type::directional;
        rows.emplace_back(light.intensity, parallel ? light.angularRadius : light.rangeMeters);
        rows.emplace_back(light.direction, web ? float(web->verticalSteps) : light.cosInnerCone);
        rows.emplace_back(web ? float(web->horizontalSteps) : light.cosOuterCone, float(layer),
                          float(layersOf(light)), parallel ? discTexels(light, size) : leastSquared);
        rows.emplace_back(light.horizontalZero, photometries.first[i]);
        layer += layersOf(light);
    }
    for (const glm::mat4& clipFromWorld : views)
        for (int column = 0; column < 4; ++column) rows.push_back(clipFromWorld[column]);
    rows.insert(rows.end(), photometries.texels.begin(), photometries.texels.end());
    return createTable(rows);
}

}  // namespace

bool hasDisc(const std::vector<PunctualLight>& lights) {
    return std::any_of(lights.begin(), lights.end(),
                       [](const PunctualLight& light) { return light.angularRadius > 0; });
}

ShadowMaps renderShadowMaps(const std::vector<PunctualLight>& lights, std::span<const ShadowCasters> casters,
                            const ShadowPrograms& programs) {
    Bounds bounds;
    for (const ShadowCasters& some : casters)
        if (!some.scene.bounds.empty()) bounds.add(some.scene.bounds.low), bounds.add(some.scene.bounds.high);
    size_t layers = 0;
    for (const PunctualLight& light : lights) layers += size_t(layersOf(light));
    const int size = lights.empty() ? 1 : mapSize(layers);
    std::vector<glm::mat4> views;
    for (const PunctualLight& light : lights) addViews(light, bounds, size, views);

    ShadowMaps maps;
    maps.lightCount = int(lights.size());
    maps.depth = createDepthArray(size, std::max(1, int(views.size())));
    if (hasDisc(lights)) maps.depthValues = viewWithoutComparison(maps.depth, std::max(1, int(views.size())));
    maps.lightTable = createLightTable(lights, views, size, bounds);

    // Both sides cast shadows, as they stop rays.
    glDisable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    programs.depth.use();
    for (size_t i = 0; i < views.size(); ++i) {
        const GlFramebuffer target = bindLayer(maps.depth, GL_DEPTH_ATTACHMENT, int(i), size);
        for (const ShadowCasters& some : casters) drawDepths(views[i], some, programs.depth);
    }
    glDisable(GL_DEPTH_TEST);
    const bool glass = std::any_of(casters.begin(), casters.end(),
                                   [](const ShadowCasters& some) { return !some.materials.glass.empty(); });
    if (programs.tints.name() != 0 && glass)
        maps.tints = drawAllTints(lights, views, std::max(size / kSizeOverTints, 1), casters, programs.tints);
    checkGl("drawing the shadow maps");
    return maps;
}

}  // namespace phat
