#include "gl/lookup_pass.h"

#include <algorithm>
#include <array>

#include "core/phatexel/lookup_tables.h"
#include "gl/guide_tables.h"
#include "gl/sample_numbers.h"
#include "gl/textures.h"

namespace phat {
namespace {

constexpr TableFormat kInverseCdfs = {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};

// A probe's 16x16 levels as 2x4 texels of 8x4 levels, so that neighbouring directions come in one read.
constexpr glm::uvec2 kLevels(8, 4), kProbeTexels = uint32_t(kProbeSize) / kLevels;
using ProbeTexels = std::array<glm::uvec4, kProbeTexels.x * kProbeTexels.y>;

ProbeTexels packProbe(const DepthProbe& probe) {
    ProbeTexels texels;
    texels.fill(glm::uvec4(0));
    for (uint32_t i = 0; i < kProbeSize * kProbeSize; ++i) {
        const glm::uvec2 cell(i % kProbeSize, i / kProbeSize), at = cell / kLevels;
        texels[at.y * kProbeTexels.x + at.x][int(cell.y % 4)] |= uint32_t(probe.level[i])
                                                                 << (4 * (cell.x % 8));
    }
    return texels;
}

GlTexture uploadProbes(const std::vector<DepthProbe>& probes, glm::uvec2 tiles) {
    const glm::uvec2 size = tiles * kProbeTexels;
    std::vector<glm::uvec4> texels(size_t(size.x) * size.y, glm::uvec4(0));
    for (uint32_t tile = 0; tile < probes.size(); ++tile) {
        const glm::uvec2 corner = glm::uvec2(tile % tiles.x, tile / tiles.x) * kProbeTexels;
        const ProbeTexels packed = packProbe(probes[tile]);
        for (uint32_t y = 0; y < kProbeTexels.y; ++y)
            std::copy_n(&packed[y * kProbeTexels.x], kProbeTexels.x,
                        &texels[size_t(corner.y + y) * size.x + corner.x]);
    }
    GlTexture texture = createTexture2D(GL_RGBA32UI, size);
    glTextureSubImage2D(texture.name(), 0, 0, 0, GLsizei(size.x), GLsizei(size.y), GL_RGBA_INTEGER,
                        GL_UNSIGNED_INT, texels.data());
    return texture;
}

GlTexture uploadScrambles(const std::vector<const std::vector<uint16_t>*>& scrambles) {
    const uint32_t layers = uint32_t(scrambles.size()), blocks = uint32_t(scrambles[0]->size());
    const uint32_t rows = std::max(1u, (blocks + kTablesWide - 1) / kTablesWide);
    std::vector<uint16_t> table(size_t(rows) * layers * kTablesWide, 0);
    for (uint32_t layer = 0; layer < layers; ++layer)
        for (uint32_t block = 0; block < blocks; ++block)
            table[(size_t(block / kTablesWide) * layers + layer) * kTablesWide + block % kTablesWide] =
                (*scrambles[layer])[block];
    GlTexture texture = createTexture2D(GL_R16UI, {kTablesWide, rows * layers});
    glTextureSubImage2D(texture.name(), 0, 0, 0, GLsizei(kTablesWide), GLsizei(rows * layers), GL_RED_INTEGER,
                        GL_UNSIGNED_SHORT, table.data());
    return texture;
}

}  // namespace

GpuLookup uploadLookup(const Phatexture& phatexture, const Atlas& atlas) {
    GpuLookup gpu;
    if (!canLookUp(phatexture.indirect, phatexture.indirectGuides)) return gpu;
    const bool area = !phatexture.area.empty();
    // Area lights need both, their PHATexels and their irradiance.
    if (area != !phatexture.areaIrradiance.empty()) return gpu;
    if (area && !canLookUp(phatexture.area, phatexture.areaGuides)) return gpu;
    gpu.layerCount = int(phatexture.indirect.size());
    gpu.guideCount = int(phatexture.indirectGuides.size());
    if (area) gpu.areaGuideCount = int(phatexture.areaGuides.size());
    std::vector<InverseCdf> inverseCdfs;
    std::vector<const std::vector<uint16_t>*> scrambles;
    for (const auto* guides : {&phatexture.indirectGuides, &phatexture.areaGuides})
        for (const Guide& guide : *guides) inverseCdfs.push_back(inverseCdfOf(guide));
    for (const auto* layers : {&phatexture.indirect, &phatexture.area})
        for (const PhatexelLayer& layer : *layers) scrambles.push_back(&layer.scrambles);
    gpu.inverseCdfs = uploadGuideTables(kInverseCdfs, inverseCdfs);
    if (scrambles.size() > 1) gpu.scrambles = uploadScrambles(scrambles);
    gpu.probes = uploadProbes(phatexture.probes, atlas.sizeTiles());
    checkGl("uploading the lookup tables");
    return gpu;
}

void updateLookupGuides(const GpuLookup& gpu, const LightUpdate::Guides& block) {
    const auto upload = [&](uint32_t table, const Guide& guide) {
        updateGuideTable(gpu.inverseCdfs, kInverseCdfs, table, inverseCdfOf(guide));
    };
    // Where there is one guide for all blocks, it stays.
    if (int(block.block) < gpu.guideCount) upload(block.block, block.indirect);
    if (int(block.block) < gpu.areaGuideCount) upload(uint32_t(gpu.guideCount) + block.block, block.area);
    const uint32_t layers = uint32_t(block.scrambles.size());
    for (uint32_t layer = 0; gpu.scrambles && layer < layers; ++layer)
        glTextureSubImage2D(gpu.scrambles.name(), 0, GLint(block.block % kTablesWide),
                            GLint(block.block / kTablesWide * layers + layer), 1, 1, GL_RED_INTEGER,
                            GL_UNSIGNED_SHORT, &block.scrambles[layer]);
}

void updateProbe(const GpuLookup& gpu, const LightUpdate::TileGeometry& tile, glm::uvec2 sizeTiles) {
    const glm::uvec2 corner = glm::uvec2(tile.tile % sizeTiles.x, tile.tile / sizeTiles.x) * kProbeTexels;
    const ProbeTexels packed = packProbe(tile.probe);
    glTextureSubImage2D(gpu.probes.name(), 0, GLint(corner.x), GLint(corner.y), kProbeTexels.x,
                        kProbeTexels.y, GL_RGBA_INTEGER, GL_UNSIGNED_INT, packed.data());
}

std::vector<std::string> phatexelDefines(const GpuLookup& lookup) {
    std::vector<std::string> defines;
    if (lookup.areaGuideCount > 0) defines.push_back("AREA");
    if (lookup.scrambles) defines.push_back("SCRAMBLES");
    return defines;
}

LookupPass createLookupPass(const std::string& folder, const GpuLookup& lookup, bool clearcoat,
                            bool countReads) {
    LookupPass pass;
    pass.clearcoat = clearcoat;
    pass.areaLights = lookup.areaGuideCount > 0;
    std::vector<std::string> defines = phatexelDefines(lookup);
    if (clearcoat) defines.push_back("CLEARCOAT");
    if (countReads) defines.push_back("COUNT_READS");
    pass.lobesProgram = ShaderProgram(folder, "surface.vert", "lobes.frag", defines);
    pass.lookupProgram = ShaderProgram(folder, "surface.vert", "lookup.frag", defines);
    pass.pool = FullscreenProgram(folder, "pool.frag", defines);
    return pass;
}

bool isReady(const LookupPass& pass) {
    return pass.lobesProgram.isReady() && pass.lookupProgram.isReady() && pass.pool.program.isReady();
}

LookupTargets createLookupTargets(const LookupPass& pass, glm::uvec2 size, GLuint depth, bool traced) {
    LookupTargets t;
    t.size = size;
    const int layers = t.layers = lookedUpLayers(pass);
    // Two a lobe, see uploadReflections.
    const int tracedLayers = traced ? (pass.clearcoat ? 4 : 2) : 0;
    t.incident = createTextureArray(GL_RGBA32UI, size, layers + tracedLayers);
    t.pooled = createTextureArray(GL_RGBA32UI, size, layers);
    std::vector<Attachment> incident, pooled;
    for (int i = 0; i < layers; ++i) {
        incident.push_back({t.incident.name(), 0, i});
        pooled.push_back({t.pooled.name(), 0, i});
    }
    t.incidentTarget = createFramebuffer(incident, depth);
    t.pooledTarget = createFramebuffer(pooled);
    t.reflectances = createTexture2D(GL_RGBA32UI, size);
    t.baseLobes = createTexture2D(GL_RGBA32F, size);
    std::vector<Attachment> lobes = {{t.reflectances.name()}, {t.baseLobes.name()}};
    if (pass.clearcoat) {
        t.coatLobes = createTexture2D(GL_RGBA32F, size);
        lobes.push_back({t.coatLobes.name()});
    }
    t.lobesTarget = createFramebuffer(lobes, depth);
    checkGl("creating the lookup's targets");
    return t;
}

int bindPhatexels(const ShaderProgram& program, const GpuAtlas& atlas, const GpuLookup& lookup,
                  int firstUnit) {
    int unit = firstUnit;
    program.bind("tilePatches", unit++, atlas.tilePatches.name());
    program.bind("phatexels", unit++, atlas.phatexels.name());
    program.bind("inverseCdfs", unit++, lookup.inverseCdfs.name());
    program.bind("probes", unit++, lookup.probes.name());
    program.bind("charts", unit++, atlas.charts.name());
    if (lookup.scrambles) program.bind("scrambles", unit++, lookup.scrambles.name());
    program.set("unitMeters", atlas.unitMeters);
    program.set("guideCount", lookup.guideCount);
    program.set("layerCount", lookup.layerCount);
    program.set("areaGuideCount", lookup.areaGuideCount);
    return unit;
}

void bindLobes(const ShaderProgram& program, const LookupTargets& targets, int firstUnit) {
    program.bind("reflectances", firstUnit, targets.reflectances.name());
    program.bind("baseLobes", firstUnit + 1, targets.baseLobes.name());
    if (targets.coatLobes) program.bind("coatLobes", firstUnit + 2, targets.coatLobes.name());
}

void clearSums(const LookupTargets& targets) {
    glBindFramebuffer(GL_FRAMEBUFFER, targets.incidentTarget.name());
    const GLuint none[4] = {0, 0, 0, 0};
    for (int i = 0; i < targets.layers; ++i) glClearBufferuiv(GL_COLOR, i, none);
}

void beginLobes(const LookupTargets& targets) {
    glBindFramebuffer(GL_FRAMEBUFFER, targets.lobesTarget.name());
    const GLuint noSurface[4] = {0, 0, 0, 0};
    glClearBufferuiv(GL_COLOR, 0, noSurface);
}

void beginLookup(const LookupPass& pass, const GpuAtlas& atlas, const GpuLookup& lookup,
                 const LookupTargets& targets, const LookupSampling& sampling, uint32_t seed) {
    clearSums(targets);
    const ShaderProgram& program = pass.lookupProgram;
    bindLobes(program, targets, bindPhatexels(program, atlas, lookup, 0));
    program.set("lightBits", sampling.lightBits);
    const int samples = std::clamp(sampling.sampleCount, 1, int(kMaxSamples));
    program.set("sampleCount", samples);
    setSampleNumbers(program, uint32_t(samples), seed);
}

void poolSums(const LookupPass& pass, const LookupTargets& targets) {
    const auto pool = [&](const GlTexture& from, const GlFramebuffer& to, glm::ivec2 alongWhich) {
        pass.pool.program.bind("incident", 0, from.name());
        pass.pool.program.set("alongWhich", alongWhich);
        pass.pool.draw(to, targets.size);
    };
    pool(targets.incident, targets.pooledTarget, {1, 0});
    pool(targets.pooled, targets.incidentTarget, {0, 1});
}

}  // namespace phat
