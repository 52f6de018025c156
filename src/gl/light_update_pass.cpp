#include "gl/light_update_pass.h"

#include <algorithm>
#include <bit>
#include <glm/gtc/packing.hpp>

#include "core/bake/irradiance.h"
#include "core/base/random.h"
#include "gl/textures.h"

namespace phat {
namespace {

// Steps of 1, 2, 4, 8 and 16 texels.
constexpr int kFilterPasses = 5;

// twin: the constants of trace_texels.frag.
constexpr int kDiffuseChoice = 2;

// The bake's irradiance, as if by so many samples.
constexpr float kBakedSamples = 64;
// Texel size over the distance of what is around: not known to the bake.
constexpr float kBakedNearness = 0.125f;

// twin: shaders/lib/irradiance_estimate.glsl.
GlTexture uploadEstimates(const Atlas& atlas, const std::vector<uint8_t>& receives,
                          const Phatexture& phatexture) {
    GlTexture texture = createTextureArray(GL_RGBA32UI, atlas.sizeTexels, 2);
    std::vector<glm::uvec4> texels(atlas.texelCount());
    const auto upload = [&](int source, const std::vector<uint32_t>& irradiance) {
        std::fill(texels.begin(), texels.end(), glm::uvec4(0));
        for (size_t i = 0; i < irradiance.size(); ++i) {
            if (!receives[i]) continue;
            const glm::vec3 mean = unpackRgb9e5(irradiance[i]);
            const float statistic = source == 0 ? kBakedNearness : luminance(mean);
            texels[i] = {std::bit_cast<uint32_t>(mean.x), std::bit_cast<uint32_t>(mean.y),
                         std::bit_cast<uint32_t>(mean.z), glm::packHalf2x16({kBakedSamples, statistic})};
        }
        glTextureSubImage3D(texture.name(), 0, 0, 0, source, GLsizei(atlas.sizeTexels.x),
                            GLsizei(atlas.sizeTexels.y), 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, texels.data());
    };
    upload(0, phatexture.indirectIrradiance);
    upload(1, phatexture.areaIrradiance);
    return texture;
}

enum class LayoutOf : uint64_t { rays, lights };

// Of every sixteen rounds each takes a texel into another one of the 4x4 parts of the square; where in it,
// and where its neighbours are, is another one each time.
uint32_t layoutOf(LayoutOf what, BlockTurn turn) {
    uint32_t part = 0;
    for (uint32_t bit = 0; bit < 4; ++bit) part |= (turn.rounds >> bit & 1u) << (3 - bit);
    const uint32_t first = uint32_t(hashOf(uint64_t(what), turn.block) & 15u);
    const uint32_t within = uint32_t(hashOf(uint64_t(what), turn.block, turn.rounds) & 63u);
    return (part ^ first) << 6 | within;
}

/// A batch of a round.
struct Batch {
    const LightUpdatePass& pass;
    const GpuLight& light;
    const LitWorld& world;
    TexelBatch texels;
    uint32_t seed;

    int firstGuide(size_t source) const { return source == 0 ? 0 : world.atlas.sources[0].guideCount; }
    template <typename ScrambleOf>
    void trace(int choice, int layer, size_t source, const ScrambleOf& scrambleOf) const;
    void shade() const;
    void tracePhatexels(size_t source, const LightRound& round) const;
    void compare(size_t source) const;
    void addChanges(std::vector<float>& changes) const;
    void estimateIrradiance() const;
};

template <typename ScrambleOf>
void Batch::trace(int choice, int layer, size_t source, const ScrambleOf& scrambleOf) const {
    const ShaderProgram& program = pass.trace.program;
    bindBvh(world.rays.bvh, program, 0);
    bindTexelPoints(light.points, world.atlas, program, kBvhUnits);
    int unit = kBvhUnits + kTexelPointUnits;
    program.bind("guideSums", unit++, light.guides.sums.name());
    program.bind("phatexels", unit++, world.atlas.phatexels.name());
    program.bind("tilePatches", unit++, world.atlas.tilePatches.name());
    program.set("unitMeters", world.atlas.unitMeters);
    program.set("originUnitMeters", world.atlas.unitMeters);
    program.set("choice", choice);
    program.set("layer", layer);
    program.set("firstGuide", firstGuide(source));
    program.set("guideCount", world.atlas.sources[source].guideCount);
    program.set("seed", int(seed));
    texels.set(program, scrambleOf);
    pass.trace.draw(pass.raysTarget, texels.size());
}

void Batch::shade() const {
    const ShaderProgram& program = pass.shade.program;
    bindHitShading(program, world, pass.hits, pass.places);
    program.set("raySpread", 0.0f);
    program.set("regularized", 0.0f);
    program.set("ray", 0);
    pass.shade.draw(pass.lightTarget, texels.size());
}

// Directions are drawn by guides that follow from the PHATexels before, but what looks up PHATexels sees both
// change at once.
void Batch::tracePhatexels(size_t source, const LightRound& round) const {
    const GpuPhatexels& phatexels = world.atlas.sources[source];
    const std::vector<uint16_t>* scrambles = &light.scrambles[size_t(phatexels.firstLayer)];
    const GuideTurn guides{texels, phatexels, *scrambles, firstGuide(source)};
    const bool follows = round.directions == RayChoice::guided && guides.follows();
    if (follows) followGuides(pass.guides, light.guides, guides, world.atlas.phatexels);
    for (int i = 0; i < phatexels.layerCount; ++i) {
        const int layer = phatexels.firstLayer + i;
        scrambles = &light.scrambles[size_t(layer)];
        trace(int(round.directions), layer, source,
              [&](BlockTurn turn) { return uint32_t((*scrambles)[turn.block]); });
        shade();
        const ShaderProgram& program = pass.pack.program;
        program.bind("hits", 0, pass.hits.name());
        program.bind("codes", 1, pass.codes.name());
        program.bind("radiance", 2, (source == 0 ? pass.indirect : pass.area).name());
        program.set("unitMeters", world.atlas.unitMeters);
        pass.pack.draw(pass.packedTarget, texels.size());
        if (round.compares && i == 0) compare(source);
        texels.copyTexels(pass.packed, world.atlas.phatexels, layer);
        // At hits, the first layer alone is looked up.
        if (follows && i == 0) showGuides(pass.guides, guides, world.lookup);
    }
}

// Of the first layer.
void Batch::compare(size_t source) const {
    const GpuPhatexels& phatexels = world.atlas.sources[source];
    const ShaderProgram& program = pass.compare.program;
    program.bind("phatexels", 0, world.atlas.phatexels.name());
    program.bind("newPhatexels", 1, pass.packed.name());
    program.bind("guidePdf", 2, phatexels.guidePdf.name());
    program.bind("splitSumTable", 3, world.surfaces.splitSum.name());
    program.set("unitMeters", world.atlas.unitMeters);
    program.set("guideCount", phatexels.guideCount);
    program.set("layer", phatexels.firstLayer);
    texels.set(program, [](BlockTurn) { return 0u; });
    pass.compare.draw(pass.changesTargets[source], batchSize(texels.blocks.size(), kBlockTiles));
}

// Waits for the GPU.
void Batch::addChanges(std::vector<float>& changes) const {
    constexpr uint32_t kWide = kBatchSide * kBlockTiles;
    std::vector<glm::vec2> sums(2 * size_t(kWide) * kWide);
    glGetTextureImage(pass.changes.name(), 0, GL_RG, GL_FLOAT, GLsizei(sums.size() * sizeof(glm::vec2)),
                      sums.data());
    for (size_t i = 0; i < texels.blocks.size(); ++i) {
        glm::vec2 sum(0);
        for (uint32_t tile = 0; tile < kBlockTiles * kBlockTiles; ++tile) {
            const glm::uvec2 at =
                batchCorner(i, kBlockTiles) + glm::uvec2(tile % kBlockTiles, tile / kBlockTiles);
            for (size_t source = 0; source < world.atlas.sources.size(); ++source)
                sum += sums[source * kWide * kWide + at.y * kWide + at.x];
        }
        changes.push_back(sum.x > 0 ? sum.x / sum.y : 0.0f);
    }
}

void Batch::estimateIrradiance() const {
    trace(kDiffuseChoice, 0, 0, [](BlockTurn turn) { return layoutOf(LayoutOf::rays, turn); });
    shade();
    if (world.rays.hits.emitterCount > 0) {
        const ShaderProgram& program = pass.lights.program;
        bindBvh(world.rays.bvh, program, 0);
        bindTexelPoints(light.points, world.atlas, program, kBvhUnits);
        bindHits(world.rays.hits, program, kBvhUnits + kTexelPointUnits);
        program.bind("splitSumTable", kBvhUnits + kTexelPointUnits + kHitUnits,
                     world.surfaces.splitSum.name());
        program.set("originUnitMeters", world.atlas.unitMeters);
        program.set("seed", int(~seed));
        texels.set(program, [](BlockTurn turn) { return layoutOf(LayoutOf::lights, turn); });
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE);
        pass.lights.draw(pass.areaTarget, texels.size());
        glDisable(GL_BLEND);
    }
    const ShaderProgram& program = pass.estimate.program;
    program.bind("indirectLight", 0, pass.indirect.name());
    program.bind("areaLight", 1, pass.area.name());
    program.bind("estimates", 2, light.estimates.name());
    program.bind("splitSumTable", 3, world.surfaces.splitSum.name());
    program.bind("hits", 4, pass.hits.name());
    bindTexelPoints(light.points, world.atlas, program, 5);
    texels.set(program, [](BlockTurn) { return 0u; });
    pass.estimate.draw(pass.estimateTarget, texels.size());
    texels.copyTexels(pass.indirectEstimate, light.estimates, 0);
    texels.copyTexels(pass.areaEstimate, light.estimates, 1);
}

}  // namespace

GpuLight createGpuLight(const Scene& scene, const Atlas& atlas, const TexelPoints& points,
                        const Phatexture& phatexture) {
    GpuLight light;
    light.points = uploadTexelPoints(scene, atlas, points);
    light.moved = createMovedTexels(scene, atlas, points);
    light.guides = uploadGuideSums(phatexture);
    light.estimates = uploadEstimates(atlas, irradianceTexels(atlas, points), phatexture);
    light.blocks = blockRects(atlas);
    for (const auto* layers : {&phatexture.indirect, &phatexture.area})
        for (const PhatexelLayer& layer : *layers) light.scrambles.push_back(layer.scrambles);
    checkGl("preparing light on the GPU");
    return light;
}

LightUpdatePass createLightUpdatePass(const std::string& folder, const GpuAtlas& atlas,
                                      const GpuLookup& lookup, const std::vector<std::string>& bvhDefines) {
    LightUpdatePass pass;
    pass.guides = createGuidePass(folder);
    pass.moved = createMovedTexelsPass(folder, bvhDefines);
    pass.bounds = createTileBoundsPass(folder, atlas);
    pass.trace = FullscreenProgram(folder, "trace_texels.frag", bvhDefines);
    std::vector<std::string> shading = phatexelDefines(lookup);
    shading.push_back("TEXELS");
    pass.shade = FullscreenProgram(folder, "shade_reflections.frag", shading);
    pass.lights = FullscreenProgram(folder, "light_texels.frag", bvhDefines);
    pass.pack = FullscreenProgram(folder, "pack_phatexels.frag");
    pass.compare = FullscreenProgram(folder, "compare_phatexels.frag");
    pass.estimate = FullscreenProgram(folder, "estimate_irradiance.frag");
    pass.filterFirst = FullscreenProgram(folder, "filter_irradiance.frag", {"FIRST"});
    pass.filter = FullscreenProgram(folder, "filter_irradiance.frag");
    const glm::uvec2 size = batchTarget(kBlockSize);
    for (GlTexture* words : {&pass.hits, &pass.places, &pass.indirectEstimate, &pass.areaEstimate})
        *words = createTexture2D(GL_RGBA32UI, size);
    pass.codes = createTexture2D(GL_R32UI, size);
    pass.packed = createTexture2D(GL_RG32UI, size);
    pass.indirect = createTexture2D(GL_RGBA16F, size);
    pass.area = createTexture2D(GL_RGBA16F, size);
    pass.raysTarget = createFramebuffer({{pass.hits.name()}, {pass.places.name()}, {pass.codes.name()}});
    pass.lightTarget = createFramebuffer({{pass.indirect.name()}, {pass.area.name()}});
    pass.areaTarget = createFramebuffer({{pass.area.name()}});
    pass.packedTarget = createFramebuffer({{pass.packed.name()}});
    pass.estimateTarget = createFramebuffer({{pass.indirectEstimate.name()}, {pass.areaEstimate.name()}});
    pass.changes = createTextureArray(GL_RG32F, batchTarget(kBlockTiles), 2);
    for (int i = 0; i < 2; ++i)
        pass.changesTargets[size_t(i)] = createFramebuffer({{pass.changes.name(), 0, i}});
    for (size_t i = 0; i < 2; ++i) {
        pass.filtered[i] = createTexture2D(GL_RGBA16F, atlas.sizeTexels);
        pass.filteredTargets[i] = createFramebuffer({{pass.filtered[i].name()}});
        pass.irradianceTargets.push_back(createFramebuffer({{atlas.irradiance.name(), 0, int(i)}}));
    }
    checkGl("creating the passes that update light");
    return pass;
}

std::vector<float> traceLight(const LightUpdatePass& pass, GpuLight& light, const LitWorld& world,
                              const LightRound& round) {
    glDisable(GL_BLEND);
    std::vector<float> changes;
    for (size_t first = 0; first < round.blocks.size(); first += kBatchBlocks) {
        const size_t count = std::min<size_t>(kBatchBlocks, round.blocks.size() - first);
        const Batch batch{pass, light, world, TexelBatch{light.blocks, round.blocks.subspan(first, count)},
                          uint32_t(hashOf(round.number, first))};
        updateMovedTexels(pass.moved, light.moved, light.points, world, batch.texels);
        for (size_t source = 0; round.phatexels && source < world.atlas.sources.size(); ++source)
            if (world.atlas.sources[source].layerCount > 0) batch.tracePhatexels(source, round);
        if (round.compares) batch.addChanges(changes);
        if (round.irradiance) batch.estimateIrradiance();
    }
    checkGl("updating light");
    return changes;
}

void filterIrradiance(const LightUpdatePass& pass, const GpuLight& light, const GpuAtlas& atlas) {
    glDisable(GL_BLEND);
    for (int source = 0; source < int(atlas.sources.size()); ++source) {
        for (int i = 0; i < kFilterPasses; ++i) {
            const FullscreenProgram& filter = i == 0 ? pass.filterFirst : pass.filter;
            const ShaderProgram& program = filter.program;
            bindTexelPoints(light.points, atlas, program, 0);
            if (i == 0)
                program.bind("estimates", kTexelPointUnits, light.estimates.name());
            else
                program.bind("before", kTexelPointUnits, pass.filtered[size_t(i + 1) % 2].name());
            program.set("source", source);
            program.set("step", 1 << i);
            const bool last = i == kFilterPasses - 1;
            filter.draw(last ? pass.irradianceTargets[size_t(source)] : pass.filteredTargets[size_t(i) % 2],
                        atlas.sizeTexels);
        }
    }
    checkGl("filtering irradiance");
}

}  // namespace phat
