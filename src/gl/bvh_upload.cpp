#include "gl/bvh_upload.h"

#include <algorithm>

#include "gl/bvh_opacity.h"
#include "gl/textures.h"

namespace phat {
namespace {

constexpr uint32_t kNodeTexels = sizeof(BvhNode) / 16, kTriangleTexels = sizeof(BvhTriangle) / 16;

struct TexelFormat {
    GLenum stored, format, type;
    size_t bytes;
};
constexpr TexelFormat kWords{GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 16};
constexpr TexelFormat kBytes{GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1};

GlTexture tableOf(const TexelFormat& format, size_t texels) {
    const size_t rows = std::max<size_t>((texels + kTableWidth - 1) / kTableWidth, 1);
    return createTexture2D(format.stored, {kTableWidth, uint32_t(rows)});
}

// Writes texels of a table: the rest of a row, whole rows, the beginning of another.
void writeTable(const GlTexture& table, const TexelFormat& format, size_t first, size_t count,
                const void* values) {
    const auto* from = static_cast<const unsigned char*>(values);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    while (count > 0) {
        const size_t column = first % kTableWidth, row = first / kTableWidth;
        const bool whole = column == 0 && count >= kTableWidth;
        const size_t width = whole ? kTableWidth : std::min(count, kTableWidth - column);
        const size_t height = whole ? count / kTableWidth : 1;
        glTextureSubImage2D(table.name(), 0, GLint(column), GLint(row), GLsizei(width), GLsizei(height),
                            format.format, format.type, from);
        first += width * height;
        count -= width * height;
        from += width * height * format.bytes;
    }
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
}

}  // namespace

GpuBvh uploadBvh(const Scene& scene, const SceneBvh& bvh) {
    GpuBvh gpu;
    gpu.grid = bvh.grid;
    gpu.nodesAtRest = uint32_t(bvh.nodes.size());
    gpu.firstTransparent = bvh.firstTransparent;
    gpu.nodes = tableOf(kWords, kNodeTexels * (bvh.nodes.size() + maxPosedNodes(bvh)));
    writeTable(gpu.nodes, kWords, 0, kNodeTexels * bvh.nodes.size(), bvh.nodes.data());
    gpu.triangles = tableOf(kWords, kTriangleTexels * bvh.triangles.size());
    writeTable(gpu.triangles, kWords, 0, kTriangleTexels * bvh.triangles.size(), bvh.triangles.data());
    updateOpacity(gpu, scene, bvh);
    checkGl("uploading the trees for rays");
    return gpu;
}

void moveBvh(GpuBvh& gpu, const PosedBvh& posed) {
    gpu.root = posed.root;
    writeTable(gpu.nodes, kWords, size_t(kNodeTexels) * gpu.nodesAtRest, kNodeTexels * posed.nodes.size(),
               posed.nodes.data());
}

void updateOpacity(GpuBvh& gpu, const Scene& scene, const SceneBvh& bvh) {
    if (bvhDefines(bvh).empty()) return;
    const OpacityTables tables = opacityTables(scene, bvh);
    gpu.firstMaterial = tables.firstMaterial;
    gpu.opacity = tableOf(kWords, tables.texels.size());
    gpu.alphas = tableOf(kBytes, tables.alphas.size());
    writeTable(gpu.opacity, kWords, 0, tables.texels.size(), tables.texels.data());
    writeTable(gpu.alphas, kBytes, 0, tables.alphas.size(), tables.alphas.data());
}

std::vector<std::string> bvhDefines(const SceneBvh& bvh) {
    if (bvh.firstTransparent == bvh.triangles.size()) return {};
    return {"BVH_OPACITY"};
}

void bindBvh(const GpuBvh& gpu, const ShaderProgram& program, int firstUnit) {
    program.set("bvhGridStep", gpu.grid.stepMeters);
    program.set("bvhRoot", int(gpu.root));
    program.bind("bvhNodes", firstUnit, gpu.nodes.name());
    program.bind("bvhTriangles", firstUnit + 1, gpu.triangles.name());
    if (!gpu.opacity) return;
    program.set("bvhFirstTransparent", int(gpu.firstTransparent));
    program.set("bvhFirstMaterial", int(gpu.firstMaterial));
    program.bind("bvhOpacity", firstUnit + 2, gpu.opacity.name());
    program.bind("bvhAlphas", firstUnit + 3, gpu.alphas.name());
}

}  // namespace phat
