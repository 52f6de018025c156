#include "gl/lookup_pass.h"

#include "core/sobol.h"
#include "gl/textures.h"

namespace phat {
namespace {

// twin: kTablesWide in shaders/lib/lookup.glsl.
constexpr uint32_t kTablesWide = 512;
constexpr uint32_t kTableSide = 16;
// Draws a pixel, and pixels of a group (4x4) that make different ones. Measured on tabletop: see
// docs/pipeline.md.
constexpr int kDrawsPerPixel = 16, kRanks = 16;

template <typename Table>
GlTexture uploadTables(GLenum internal, GLenum format, const std::vector<Table>& tables) {
    static_assert(sizeof(Table) % (kTableSide * kTableSide) == 0);
    constexpr size_t kBytes = sizeof(Table) / (kTableSide * kTableSide);
    const uint32_t count = std::max<uint32_t>(1, uint32_t(tables.size()));
    const glm::uvec2 size(std::min(count, kTablesWide) * kTableSide,
                          (count + kTablesWide - 1) / kTablesWide * kTableSide);
    std::vector<uint8_t> pixels(size_t(size.x) * size.y * kBytes, 0);
    for (uint32_t i = 0; i < tables.size(); ++i) {
        const auto* bytes = reinterpret_cast<const uint8_t*>(&tables[i]);
        const glm::uvec2 corner = glm::uvec2(i % kTablesWide, i / kTablesWide) * kTableSide;
        for (uint32_t y = 0; y < kTableSide; ++y)
            std::copy_n(bytes + y * kTableSide * kBytes, kTableSide * kBytes,
                        &pixels[(size_t(corner.y + y) * size.x + corner.x) * kBytes]);
    }
    GlTexture texture = createTexture2D(internal, size);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(texture.name(), 0, 0, 0, GLsizei(size.x), GLsizei(size.y), format, GL_UNSIGNED_BYTE,
                        pixels.data());
    return texture;
}

// Normal as packOctahedral24, the tangent's angle from frameFromNormal's in 12 bits.
glm::uvec2 packFrame(const Frame& frame) {
    const uint32_t code = packOctahedral24(frame.normal);
    const Frame base = frameFromNormal(unpackOctahedral24(code));
    const float angle =
        std::atan2(glm::dot(frame.tangent, base.bitangent), glm::dot(frame.tangent, base.tangent));
    return {code, uint32_t(int(std::lround(angle * (4096.0f / (2 * kPi))))) & 4095u};
}

// Steps of 1.7 % from 0.01 mm on.
uint32_t packTexelSize(float meters) {
    return uint32_t(std::clamp(std::lround(40 * std::log2(meters / 1e-5f)), 0l, 1023l));
}

void fillDrawTable(GLuint table, uint32_t seed) {
    // Bayer's order: pixels side by side make draws that are far apart.
    constexpr int kBayer[kRanks] = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
    std::vector<glm::vec4> numbers(size_t(kDrawsPerPixel) * kRanks);
    for (size_t rank = 0; rank < kRanks; ++rank)
        for (size_t k = 0; k < kDrawsPerPixel; ++k)
            numbers[rank * kDrawsPerPixel + k] =
                sobol4(uint32_t(size_t(kBayer[rank]) * kDrawsPerPixel + k), seed);
    glTextureSubImage2D(table, 0, 0, 0, kDrawsPerPixel, kRanks, GL_RGBA, GL_FLOAT, numbers.data());
}

GlTexture uploadScrambles(const std::vector<std::vector<uint16_t>>& scrambles) {
    const uint32_t layers = uint32_t(scrambles.size()), blocks = uint32_t(scrambles[0].size());
    const uint32_t rows = std::max(1u, (blocks + kTablesWide - 1) / kTablesWide);
    std::vector<uint16_t> table(size_t(rows) * layers * kTablesWide, 0);
    for (uint32_t layer = 0; layer < layers; ++layer)
        for (uint32_t block = 0; block < blocks; ++block)
            table[(size_t(block / kTablesWide) * layers + layer) * kTablesWide + block % kTablesWide] =
                scrambles[layer][block];
    GlTexture texture = createTexture2D(GL_R16UI, {kTablesWide, rows * layers});
    glTextureSubImage2D(texture.name(), 0, 0, 0, GLsizei(kTablesWide), GLsizei(rows * layers), GL_RED_INTEGER,
                        GL_UNSIGNED_SHORT, table.data());
    return texture;
}

}  // namespace

GpuLookup uploadLookup(const LookupTables& tables, const Atlas& atlas, const std::vector<Frame>& frames) {
    GpuLookup gpu;
    if (tables.warps.empty()) return gpu;
    gpu.layerCount = int(tables.scrambles.size());
    gpu.guideCount = int(tables.warps.size());
    const glm::uvec2 size = atlas.sizeTiles();
    std::vector<uint32_t> chartTiles(atlas.charts.size(), 0);
    for (uint32_t chart : atlas.tileChart)
        if (chart != kNoChart) ++chartTiles[chart];
    std::vector<glm::uvec4> tiles(size_t(size.x) * size.y, glm::uvec4(kNoChart, 0, 0, 0));
    for (uint32_t y = 0; y < size.y; ++y) {
        for (uint32_t x = 0; x < size.x; ++x) {
            const uint32_t chart = atlas.tileChart[size_t(y) * size.x + x];
            if (chart == kNoChart) continue;
            const uint32_t block = atlas.blockAt(glm::uvec2(x, y) * kTileSize);
            const glm::uvec2 place =
                (glm::uvec2(x, y) - atlas.charts[chart].originTile) % (kBlockSize / kTileSize);
            const glm::uvec2 frame = packFrame(frames[block]);
            tiles[size_t(y) * size.x + x] = {
                chart | packTexelSize(atlas.charts[chart].texelSizeMeters) << 22,
                block | (place.x << 28) | (place.y << 30),
                frame.x | uint32_t(8 * std::log2(64.0f * float(chartTiles[chart]))) << 24,
                frame.y | (uint32_t(tables.scrambles[0][block]) << 12)};
        }
    }
    gpu.tiles = createTexture2D(GL_RGBA32UI, size);
    glTextureSubImage2D(gpu.tiles.name(), 0, 0, 0, GLsizei(size.x), GLsizei(size.y), GL_RGBA_INTEGER,
                        GL_UNSIGNED_INT, tiles.data());
    gpu.warps = uploadTables(GL_RGBA8, GL_RGBA, tables.warps);
    if (gpu.layerCount > 1) gpu.scrambles = uploadScrambles(tables.scrambles);
    gpu.probes = uploadTables(GL_R8UI, GL_RED_INTEGER, tables.probes);
    checkGl("uploading the lookup tables");
    return gpu;
}

LookupPass createLookupPass(const std::string& folder, const GpuAtlas& atlas, const GpuLookup& lookup,
                            bool clearcoat) {
    LookupPass pass;
    pass.clearcoat = clearcoat;
    pass.areaLights = atlas.sources.size() > 1;
    std::vector<std::string> defines;
    if (clearcoat) defines.push_back("CLEARCOAT");
    if (pass.areaLights) defines.push_back("AREA");
    if (lookup.layerCount > 1) defines.push_back("LAYERS");
    pass.lookupProgram = ShaderProgram(folder, "surface.vert", "lookup.frag", defines);
    pass.poolProgram = ShaderProgram(folder, "fullscreen.vert", "pool.frag", defines);
    pass.draws = createTexture2D(GL_RGBA32F, {kDrawsPerPixel, kRanks});
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    pass.noVertices = GlVertexArray(name);
    return pass;
}

LookupTargets createLookupTargets(const LookupPass& pass, glm::uvec2 size, GLuint depth, bool traced) {
    LookupTargets t;
    t.seen = createTexture2D(GL_RGBA32F, size);
    t.surfaces = createTexture2D(GL_RGBA32F, size);
    t.places = createTexture2D(GL_RGBA32F, size);
    t.glossy = createTextureArray(GL_RGBA32F, size, (traced ? 2 : 1) * lookedUpLayers(pass));
    const GLuint seen = t.seen.name(), surfaces = t.surfaces.name(), places = t.places.name();
    const GLuint glossy = t.glossy.name();
    if (pass.clearcoat) {
        t.seenCoat = createTexture2D(GL_RGBA32F, size);
        t.lookupTarget = createFramebuffer({{seen}, {surfaces}, {places}, {t.seenCoat.name()}}, depth);
        t.poolTarget = createFramebuffer({{glossy, 0, 0}, {glossy, 0, 1}, {glossy, 0, 2}, {glossy, 0, 3}});
    } else {
        t.lookupTarget = createFramebuffer({{seen}, {surfaces}, {places}}, depth);
        t.poolTarget = createFramebuffer({{glossy, 0, 0}, {glossy, 0, 1}});
    }
    checkGl("creating the lookup's targets");
    return t;
}

void beginLookup(const LookupPass& pass, const GpuAtlas& atlas, const GpuLookup& lookup,
                 const LookupTargets& targets, uint32_t seed) {
    fillDrawTable(pass.draws.name(), seed);
    glBindFramebuffer(GL_FRAMEBUFFER, targets.lookupTarget.name());
    const GLfloat nothing[4] = {0, 0, 0, 0};
    for (int i = 0; i < (pass.clearcoat ? 4 : 3); ++i) glClearBufferfv(GL_COLOR, i, nothing);
    const ShaderProgram& program = pass.lookupProgram;
    program.bind("lookupTiles", 0, lookup.tiles.name());
    program.bind("phatexels", 1, atlas.sources[0].texels.name());
    program.bind("warps", 2, lookup.warps.name());
    program.bind("probes", 3, lookup.probes.name());
    program.bind("texelPosition", 4, atlas.position.name());
    program.bind("draws", 5, pass.draws.name());
    if (lookup.layerCount > 1) program.bind("scrambles", 6, lookup.scrambles.name());
    program.set("guideCount", lookup.guideCount);
    program.set("layerCount", lookup.layerCount);
    program.set("drawCount", kDrawsPerPixel);
}

void poolDraws(const LookupPass& pass, const GpuAtlas& atlas, const RelightPass& relit,
               const LookupTargets& targets) {
    glBindFramebuffer(GL_FRAMEBUFFER, targets.poolTarget.name());
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    const ShaderProgram& program = pass.poolProgram;
    program.bind("seen", 0, targets.seen.name());
    program.bind("surfaces", 1, targets.surfaces.name());
    program.bind("places", 2, targets.places.name());
    if (pass.clearcoat) program.bind("seenCoat", 3, targets.seenCoat.name());
    program.bind("tileTable", 4, atlas.tileTable.name());
    program.bind("relit", 5, relit.lobes.name());
    program.bind("radii", 6, relit.radii.name());
    glBindVertexArray(pass.noVertices.name());
    program.use();
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace phat
