#include "gl/phatexture_upload.h"

#include <bit>

#include "core/phatexel/radiance_bound.h"
#include "gl/gl_error.h"
#include "gl/guide_tables.h"
#include "gl/textures.h"

namespace phat {
namespace {

constexpr TableFormat kDensities = {GL_R32F, GL_RED, GL_FLOAT};

// 1/sr, of a cell that weighs 1.
constexpr float kDensityOfUnit = float(kGuideCells) / (2.0f * kPi * float(kGuideTotal));

using GuidePdf = std::array<float, kGuideCells>;

GuidePdf guidePdf(const Guide& guide) {
    GuidePdf pdf;
    for (size_t i = 0; i < pdf.size(); ++i) pdf[i] = float(guide.weight[i]) * kDensityOfUnit;
    return pdf;
}

GlTexture uploadGuides(const std::vector<Guide>& guides) {
    std::vector<GuidePdf> densities;
    for (const Guide& guide : guides) densities.push_back(guidePdf(guide));
    return uploadGuideTables(kDensities, densities);
}

void addSource(GpuAtlas& gpu, const std::vector<PhatexelLayer>& layers, const std::vector<Guide>& guides) {
    GpuPhatexels source;
    if (!gpu.sources.empty())
        source.firstLayer = gpu.sources.back().firstLayer + gpu.sources.back().layerCount;
    source.layerCount = int(layers.size());
    source.guideCount = int(guides.size());
    source.guidePdf = uploadGuides(guides);
    const GLsizei width = GLsizei(gpu.sizeTexels.x), height = GLsizei(gpu.sizeTexels.y);
    if (!layers.empty() && !layers[0].pdf.empty())
        source.texelPdf = createTextureArray(GL_R32F, gpu.sizeTexels, source.layerCount);
    for (int i = 0; i < source.layerCount; ++i) {
        glTextureSubImage3D(gpu.phatexels.name(), 0, 0, 0, source.firstLayer + i, width, height, 1,
                            GL_RG_INTEGER, GL_UNSIGNED_INT, layers[size_t(i)].texels.data());
        if (source.texelPdf)
            glTextureSubImage3D(source.texelPdf.name(), 0, 0, 0, i, width, height, 1, GL_RED, GL_FLOAT,
                                layers[size_t(i)].pdf.data());
    }
    gpu.sources.push_back(std::move(source));
}

GlTexture uploadTileTable(const Atlas& atlas) {
    const glm::uvec2 tiles = atlas.sizeTiles();
    std::vector<glm::uvec4> table(atlas.tileChart.size());
    for (uint32_t y = 0; y < tiles.y; ++y) {
        for (uint32_t x = 0; x < tiles.x; ++x) {
            const uint32_t chart = atlas.tileChart[size_t(y) * tiles.x + x];
            const uint32_t block = chart == kNoChart ? kNoChart : atlas.blockAt(glm::uvec2(x, y) * kTileSize);
            const float texelSize = chart == kNoChart ? 0.0f : atlas.charts[chart].texelSizeMeters;
            table[size_t(y) * tiles.x + x] = {chart, block, std::bit_cast<uint32_t>(texelSize), 0};
        }
    }
    GlTexture texture = createTexture2D(GL_RGBA32UI, tiles);
    glTextureSubImage2D(texture.name(), 0, 0, 0, GLsizei(tiles.x), GLsizei(tiles.y), GL_RGBA_INTEGER,
                        GL_UNSIGNED_INT, table.data());
    return texture;
}

GlTexture uploadTilePatches(const Atlas& atlas, const std::vector<PackedTile>& patches) {
    const glm::uvec2 size(2 * atlas.sizeTiles().x, atlas.sizeTiles().y);
    GlTexture texture = createTexture2D(GL_RGBA32UI, size);
    glTextureSubImage2D(texture.name(), 0, 0, 0, GLsizei(size.x), GLsizei(size.y), GL_RGBA_INTEGER,
                        GL_UNSIGNED_INT, patches.data());
    return texture;
}

GlTexture uploadCharts(const Atlas& atlas) {
    const uint32_t rows = uint32_t(atlas.charts.size() / kTableWidth + 1);
    std::vector<glm::uvec4> table(size_t(rows) * kTableWidth, glm::uvec4(0));
    for (size_t i = 0; i < atlas.charts.size(); ++i) {
        const Chart& chart = atlas.charts[i];
        table[i] = {chart.originTile.y << 16 | chart.originTile.x,
                    chart.sizeTiles.y << 16 | chart.sizeTiles.x, chart.firstBlock,
                    std::bit_cast<uint32_t>(chart.texelSizeMeters)};
    }
    GlTexture texture = createTexture2D(GL_RGBA32UI, {kTableWidth, rows});
    glTextureSubImage2D(texture.name(), 0, 0, 0, GLsizei(kTableWidth), GLsizei(rows), GL_RGBA_INTEGER,
                        GL_UNSIGNED_INT, table.data());
    return texture;
}

GlTexture uploadTileLight(const Scene& scene, const Atlas& atlas, const Phatexture& phatexture) {
    const glm::uvec2 tiles = atlas.sizeTiles();
    const std::vector<glm::vec4> light = tileLight(scene, atlas, phatexture);
    GlTexture texture = createTexture2D(GL_RGBA32F, tiles);
    glTextureSubImage2D(texture.name(), 0, 0, 0, GLsizei(tiles.x), GLsizei(tiles.y), GL_RGBA, GL_FLOAT,
                        light.data());
    return texture;
}

// Half floats end there: brighter irradiance is clamped.
constexpr float kLargestHalf = 65504.0f;

GlTexture uploadIrradiance(const Phatexture& phatexture, glm::uvec2 size) {
    GlTexture texture = createTextureArray(GL_RGBA16F, size, 2);
    const auto upload = [&](int index, const std::vector<uint32_t>& packed) {
        std::vector<glm::vec3> layer(size_t(size.x) * size.y, glm::vec3(0));
        for (size_t i = 0; i < packed.size(); ++i)
            layer[i] = glm::min(unpackRgb9e5(packed[i]), glm::vec3(kLargestHalf));
        glTextureSubImage3D(texture.name(), 0, 0, 0, index, GLsizei(size.x), GLsizei(size.y), 1, GL_RGB,
                            GL_FLOAT, layer.data());
    };
    upload(0, phatexture.indirectIrradiance);
    upload(1, phatexture.areaIrradiance);
    return texture;
}

void requireSizes(const Atlas& atlas, const Phatexture& phatexture) {
    const size_t count = atlas.texelCount();
    const auto fits = [&](size_t size) { return size == count || size == 0; };
    bool good = count > 0 && fits(phatexture.indirectIrradiance.size()) &&
                fits(phatexture.areaIrradiance.size()) &&
                phatexture.tilePatches.size() == atlas.tileChart.size();
    for (const auto* layers : {&phatexture.indirect, &phatexture.area})
        for (const PhatexelLayer& layer : *layers)
            good = good && layer.texels.size() == count && fits(layer.pdf.size());
    if (!good) throw GlError("the atlas and its PHATexels differ in size");
}

}  // namespace

GpuAtlas uploadAtlas(const Scene& scene, const Atlas& atlas, const Phatexture& phatexture) {
    requireSizes(atlas, phatexture);
    GpuAtlas gpu;
    gpu.sizeTexels = atlas.sizeTexels;
    gpu.coarsestTexelMeters = atlas.texelSizeMeters;
    gpu.unitMeters = atlas.unitMeters;
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gpu.tileTable = uploadTileTable(atlas);
    gpu.tileLight = uploadTileLight(scene, atlas, phatexture);
    gpu.tilePatches = uploadTilePatches(atlas, phatexture.tilePatches);
    gpu.charts = uploadCharts(atlas);
    gpu.irradiance = uploadIrradiance(phatexture, atlas.sizeTexels);
    const size_t layers = phatexture.indirect.size() + phatexture.area.size();
    gpu.phatexels = createTextureArray(GL_RG32UI, atlas.sizeTexels, std::max(1, int(layers)));
    addSource(gpu, phatexture.indirect, phatexture.indirectGuides);
    if (!phatexture.area.empty() || !phatexture.areaIrradiance.empty())
        addSource(gpu, phatexture.area, phatexture.areaGuides);
    checkGl("uploading the PHATexels");
    return gpu;
}

namespace {

glm::ivec2 tileCorner(const GpuAtlas& gpu, uint32_t tile) {
    const uint32_t wide = gpu.sizeTexels.x / kTileSize;
    return glm::ivec2(tile % wide, tile / wide) * int(kTileSize);
}

}  // namespace

void updatePhatexels(const GpuAtlas& gpu, const LightUpdate::Phatexels& tile) {
    const glm::ivec2 corner = tileCorner(gpu, tile.tile);
    size_t next = 0;
    for (const GpuPhatexels& source : gpu.sources)
        for (int layer = 0; layer < source.layerCount; ++layer, next += kTileTexels)
            glTextureSubImage3D(gpu.phatexels.name(), 0, corner.x, corner.y, source.firstLayer + layer,
                                kTileSize, kTileSize, 1, GL_RG_INTEGER, GL_UNSIGNED_INT, &tile.texels[next]);
}

void updateIrradiance(const GpuAtlas& gpu, const LightUpdate::Irradiance& tile) {
    const glm::ivec2 corner = tileCorner(gpu, tile.tile);
    std::array<glm::vec3, 2 * kTileTexels> values;
    for (size_t i = 0; i < kTileTexels; ++i) {
        values[i] = glm::min(unpackRgb9e5(tile.indirect[i]), glm::vec3(kLargestHalf));
        values[kTileTexels + i] = glm::min(unpackRgb9e5(tile.area[i]), glm::vec3(kLargestHalf));
    }
    glTextureSubImage3D(gpu.irradiance.name(), 0, corner.x, corner.y, 0, kTileSize, kTileSize, 2, GL_RGB,
                        GL_FLOAT, values.data());
}

void updateTilePatch(const GpuAtlas& gpu, const LightUpdate::TileGeometry& tile) {
    const uint32_t wide = gpu.sizeTexels.x / kTileSize;
    glTextureSubImage2D(gpu.tilePatches.name(), 0, GLint(2 * (tile.tile % wide)), GLint(tile.tile / wide), 2,
                        1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, tile.packed.data());
}

void updateGuides(const GpuAtlas& gpu, const LightUpdate::Guides& block) {
    const Guide* guides[] = {&block.indirect, &block.area};
    for (size_t s = 0; s < gpu.sources.size(); ++s) {
        if (int(block.block) >= gpu.sources[s].guideCount) continue;  // one for all, which stays
        updateGuideTable(gpu.sources[s].guidePdf, kDensities, block.block, guidePdf(*guides[s]));
    }
}

void updateTileLight(const GpuAtlas& gpu, const std::vector<glm::vec4>& light) {
    glTextureSubImage2D(gpu.tileLight.name(), 0, 0, 0, GLsizei(gpu.sizeTexels.x / kTileSize),
                        GLsizei(gpu.sizeTexels.y / kTileSize), GL_RGBA, GL_FLOAT, light.data());
}

namespace {

std::vector<Guide> readGuides(const GpuPhatexels& source) {
    const GLsizei wide = GLsizei(std::min(uint32_t(source.guideCount), kTablesWide)) * kGuideSize;
    const GLsizei high = (source.guideCount + GLsizei(kTablesWide) - 1) / GLsizei(kTablesWide) * kGuideSize;
    std::vector<float> densities(size_t(wide) * size_t(high));
    glGetTextureImage(source.guidePdf.name(), 0, GL_RED, GL_FLOAT, GLsizei(densities.size() * sizeof(float)),
                      densities.data());
    std::vector<Guide> guides(size_t(source.guideCount));
    for (size_t guide = 0; guide < guides.size(); ++guide) {
        const glm::uvec2 corner = guideCorner(uint32_t(guide));
        for (uint32_t i = 0; i < kGuideCells; ++i) {
            const glm::uvec2 at = corner + glm::uvec2(i % kGuideSize, i / kGuideSize);
            guides[guide].weight[i] =
                uint16_t(std::lround(densities[size_t(at.y) * size_t(wide) + at.x] / kDensityOfUnit));
        }
    }
    return guides;
}

}  // namespace

StoredLight readLight(const GpuAtlas& gpu) {
    StoredLight light;
    const GLsizei width = GLsizei(gpu.sizeTexels.x), height = GLsizei(gpu.sizeTexels.y);
    const size_t count = size_t(width) * size_t(height);
    const auto read = [&](const GlTexture& texture, int layer, GLenum format, GLenum type, auto& values) {
        values.resize(count);
        glGetTextureSubImage(texture.name(), 0, 0, 0, layer, width, height, 1, format, type,
                             GLsizei(count * sizeof(values[0])), values.data());
    };
    for (const GpuPhatexels& source : gpu.sources)
        for (int layer = 0; layer < source.layerCount; ++layer)
            read(gpu.phatexels, source.firstLayer + layer, GL_RG_INTEGER, GL_UNSIGNED_INT,
                 light.phatexels.emplace_back());
    for (size_t source = 0; source < gpu.sources.size(); ++source)
        light.guides[source] = readGuides(gpu.sources[source]);
    for (int source = 0; source < 2; ++source)
        read(gpu.irradiance, source, GL_RGB, GL_FLOAT, light.irradiance[size_t(source)]);
    light.tileLight.resize(count / (kTileSize * kTileSize));
    glGetTextureImage(gpu.tileLight.name(), 0, GL_RGBA, GL_FLOAT,
                      GLsizei(light.tileLight.size() * sizeof(glm::vec4)), light.tileLight.data());
    checkGl("reading light");
    return light;
}

}  // namespace phat
