#include "gl/texel_points.h"

#include <oneapi/tbb/parallel_for.h>

#include <bit>
#include <glm/gtc/matrix_access.hpp>
#include <glm/gtc/packing.hpp>
#include <limits>

#include "core/bake/irradiance.h"
#include "core/base/octahedral.h"
#include "gl/gl_error.h"
#include "gl/textures.h"

namespace phat {
namespace {

// twin: shaders/lib/texel_point.glsl; octahedral directions have no such halves.
constexpr uint32_t kNoIrradiance = 0x80008000u, kCovered = 0x80008001u;

uint32_t packDirection(glm::vec3 direction) {
    return glm::packSnorm2x16(octahedralFromDirection(direction));
}

}  // namespace

bool mayBeCovered(const TexelPoints& points, size_t texel) {
    if (points.state[texel] != TexelState::occluded) return points.valid(texel);
    const glm::vec2 b = points.barycentric[texel];
    return points.triangle[texel] != kNoTriangle && b.x >= 0 && b.y >= 0 && b.x + b.y <= 1;
}

GpuTexelPoints uploadTexelPoints(const Scene& scene, const Atlas& atlas, const TexelPoints& points) {
    if (points.triangle.size() != atlas.texelCount())
        throw GlError("the atlas and its texels differ in size");
    GpuTexelPoints gpu{createTexture2D(GL_RGBA32UI, atlas.sizeTexels),
                       createTexture2D(GL_R32UI, atlas.sizeTexels),
                       createTexture2D(GL_R32UI, atlas.sizeTexels),
                       {}};
    const float none = std::numeric_limits<float>::quiet_NaN();
    std::vector<glm::uvec4> places(atlas.texelCount());
    std::vector<uint32_t> normals(atlas.texelCount()), restNormals(atlas.texelCount());
    const std::vector<uint8_t> receives = irradianceTexels(atlas, points);
    oneapi::tbb::parallel_for(size_t(0), places.size(), [&](size_t texel) {
        places[texel] = glm::uvec4(std::bit_cast<uint32_t>(none));
        if (!mayBeCovered(points, texel)) return;
        const glm::vec3 position = points.position[texel];
        places[texel] = {std::bit_cast<uint32_t>(position.x), std::bit_cast<uint32_t>(position.y),
                         std::bit_cast<uint32_t>(position.z),
                         packDirection(flatNormalOf(scene, atlas, points, texel))};
        const bool covered = points.state[texel] == TexelState::occluded;
        restNormals[texel] = covered || receives[texel] ? packDirection(points.normal[texel]) : kNoIrradiance;
        normals[texel] = covered ? kCovered : restNormals[texel];
    });
    const GLsizei width = GLsizei(atlas.sizeTexels.x), height = GLsizei(atlas.sizeTexels.y);
    glTextureSubImage2D(gpu.points.name(), 0, 0, 0, width, height, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                        places.data());
    glTextureSubImage2D(gpu.normals.name(), 0, 0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT,
                        normals.data());
    glTextureSubImage2D(gpu.restNormals.name(), 0, 0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT,
                        restNormals.data());
    moveTexelPoints(gpu, scene, atlas, {});
    checkGl("uploading the texels' points");
    return gpu;
}

void moveTexelPoints(GpuTexelPoints& gpu, const Scene& scene, const Atlas& atlas,
                     std::span<const glm::mat4> worldFromRest) {
    std::vector<glm::vec4> rows;
    for (const Chart& chart : atlas.charts) {
        const uint32_t node = scene.surfaces[chart.surface].node;
        const glm::mat4 m = node < worldFromRest.size() ? worldFromRest[node] : glm::mat4(1);
        for (int row = 0; row < 3; ++row) rows.push_back(glm::row(m, row));
    }
    gpu.poses = createTable(std::span<const glm::vec4>(rows));
}

void bindTexelPoints(const GpuTexelPoints& gpu, const GpuAtlas& atlas, const ShaderProgram& program,
                     int firstUnit) {
    program.bind("texelPoints", firstUnit, gpu.points.name());
    program.bind("texelNormals", firstUnit + 1, gpu.normals.name());
    program.bind("chartPoses", firstUnit + 2, gpu.poses.name());
    program.bind("tileTable", firstUnit + 3, atlas.tileTable.name());
}

}  // namespace phat
