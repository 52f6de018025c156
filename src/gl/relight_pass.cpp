#include "gl/relight_pass.h"

#include "gl/material_table.h"
#include "gl/textures.h"

namespace phat {
namespace {

// Indirect light's lobes come first among the base's and among the coats'; its irradiance comes last.
bool ofIndirect(const GpuAtlas& atlas, int lobe) {
    return lobe % int(atlas.sources.size()) == 0;
}

// Means of samples need neither statistics nor radii.
bool isMean(const RelightPass& pass, const GpuAtlas& atlas, int lobe) {
    return pass.paper && ofIndirect(atlas, lobe);
}

GlFramebuffer relightTarget(const RelightPass& pass, int source, int sources) {
    const GLuint lobes = pass.lobes.name(), statistics = pass.statistics.name();
    if (pass.paper && source == 0) {
        const int irradiance = pass.lobeCount - 1;
        return pass.clearcoat
                   ? createFramebuffer({{lobes, 0, 0}, {lobes, 0, irradiance}, {lobes, 0, sources}})
                   : createFramebuffer({{lobes, 0, 0}, {lobes, 0, irradiance}});
    }
    const int coat = source + sources;
    return pass.clearcoat
               ? createFramebuffer(
                     {{lobes, 0, source}, {statistics, 0, source}, {lobes, 0, coat}, {statistics, 0, coat}})
               : createFramebuffer({{lobes, 0, source}, {statistics, 0, source}});
}

void createTargets(RelightPass& pass, const GpuAtlas& atlas) {
    const int sources = int(atlas.sources.size());
    pass.lobeCount = (pass.clearcoat ? 2 * sources : sources) + (pass.paper ? 1 : 0);
    pass.texelBrdf = createTexture2D(GL_RGBA16F, atlas.sizeTexels);
    pass.lobes = createTextureArray(GL_RGBA32F, atlas.sizeTexels, pass.lobeCount, kTopLevel + 1);
    pass.statistics = createTextureArray(GL_RG32F, atlas.sizeTexels, pass.lobeCount, kTopLevel + 1);
    pass.radii = createTextureArray(GL_RGBA32F, atlas.sizeTexels / kTileSize, pass.lobeCount);

    const GLuint lobes = pass.lobes.name(), statistics = pass.statistics.name();
    pass.brdfTarget = createFramebuffer({{pass.texelBrdf.name()}});
    for (int s = 0; s < sources; ++s) pass.relightTargets.push_back(relightTarget(pass, s, sources));
    for (int lobe = 0; lobe < pass.lobeCount; ++lobe) {
        auto& levels = pass.pyramidTargets.emplace_back();
        for (int level = 1; level <= kTopLevel; ++level)
            levels.push_back(isMean(pass, atlas, lobe)
                                 ? createFramebuffer({{lobes, level, lobe}})
                                 : createFramebuffer({{lobes, level, lobe}, {statistics, level, lobe}}));
        pass.radiusTargets.push_back(createFramebuffer({{pass.radii.name(), 0, lobe}}));
    }
}

// Only `level` may be read, so that drawing to the next one is no feedback loop; < 0: all levels.
void exposeLevels(GLuint texture, int level) {
    glTextureParameteri(texture, GL_TEXTURE_BASE_LEVEL, std::max(level, 0));
    glTextureParameteri(texture, GL_TEXTURE_MAX_LEVEL, level < 0 ? kTopLevel : level);
}

}  // namespace

RelightPass createRelightPass(const std::string& folder, const GpuAtlas& atlas, bool clearcoat, bool paper) {
    RelightPass pass;
    pass.clearcoat = clearcoat;
    pass.paper = paper;
    pass.material = FullscreenProgram(folder, "texel_material.frag");
    for (size_t s = 0; s < atlas.sources.size(); ++s) {
        const GpuPhatexels& source = atlas.sources[s];
        std::vector<std::string> defines;
        if (s == 1) defines.push_back("AREA");
        if (source.texelPdf) defines.push_back("TEXEL_PDF");
        if (clearcoat) defines.push_back("CLEARCOAT");
        const char* shader = paper && s == 0 ? "relight_paper.frag" : "relight.frag";
        pass.relight.emplace_back(folder, shader, defines);
    }
    pass.pyramid = FullscreenProgram(folder, "pyramid.frag");
    pass.radius = FullscreenProgram(folder, "radius.frag");
    createTargets(pass, atlas);
    checkGl("creating the relight targets");
    return pass;
}

void applyMaterials(const RelightPass& pass, const GpuAtlas& atlas, const GpuTexelSurfaces& surfaces,
                    const std::vector<Material>& materials) {
    const GlTexture table = createTable(packFactors(materials));
    const ShaderProgram& program = pass.material.program;
    program.bind("texelMaterial", 0, surfaces.materialIndex.name());
    program.bind("texelTexturesA", 1, surfaces.texturesA.name());
    program.bind("texelTexturesB", 2, surfaces.texturesB.name());
    program.bind("materialTable", 3, table.name());
    pass.material.draw(pass.brdfTarget, atlas.sizeTexels);
}

void relight(const RelightPass& pass, const GpuAtlas& atlas, const GpuTexelSurfaces& surfaces,
             GLuint splitSum, const Eye& eye) {
    for (size_t s = 0; s < atlas.sources.size(); ++s) {
        const GpuPhatexels& source = atlas.sources[s];
        const ShaderProgram& program = pass.relight[s].program;
        program.bind("tileTable", 0, atlas.tileTable.name());
        program.bind("phatexels", 1, atlas.phatexels.name());
        program.bind("guidePdf", 2, source.guidePdf.name());
        program.bind("tilePatches", 4, atlas.tilePatches.name());
        program.bind("texelNormals", 5, surfaces.normals.name());
        program.bind("texelBrdf", 6, pass.texelBrdf.name());
        program.bind("splitSumTable", 8, splitSum);
        program.bind("tileLight", 9, atlas.tileLight.name());
        if (source.texelPdf) program.bind("texelPdf", 7, source.texelPdf.name());
        program.set("unitMeters", atlas.unitMeters);
        program.set("eyeWorld", eye.position);
        program.set("eyeAtInfinity", eye.atInfinity ? 1.0f : 0.0f);
        program.set("firstLayer", source.firstLayer);
        program.set("layerCount", source.layerCount);
        program.set("guideCount", source.guideCount);
        pass.relight[s].draw(pass.relightTargets[s], atlas.sizeTexels);
    }
}

void buildPyramid(const RelightPass& pass, const GpuAtlas& atlas) {
    const GLuint lobes = pass.lobes.name(), statistics = pass.statistics.name();
    const ShaderProgram& pyramid = pass.pyramid.program;
    pyramid.bind("finerLobe", 0, lobes);
    pyramid.bind("finerStatistics", 1, statistics);
    for (int level = 1; level <= kTopLevel; ++level) {
        exposeLevels(lobes, level - 1);
        exposeLevels(statistics, level - 1);
        for (int lobe = 0; lobe < pass.lobeCount; ++lobe) {
            pyramid.set("lobeIndex", lobe);
            pass.pyramid.draw(pass.pyramidTargets[lobe][level - 1], atlas.sizeTexels >> uint32_t(level));
        }
    }
    exposeLevels(lobes, -1);
    exposeLevels(statistics, -1);

    const ShaderProgram& radius = pass.radius.program;
    radius.bind("tileTable", 0, atlas.tileTable.name());
    radius.bind("pyramid", 1, lobes);
    radius.bind("statistics", 2, statistics);
    radius.bind("tileLight", 3, atlas.tileLight.name());
    for (int lobe = 0; lobe < pass.lobeCount; ++lobe) {
        if (isMean(pass, atlas, lobe)) continue;
        radius.set("lobeIndex", lobe);
        radius.set("areaLights", ofIndirect(atlas, lobe) ? 0 : 1);
        pass.radius.draw(pass.radiusTargets[lobe], atlas.sizeTexels / kTileSize);
    }
}

}  // namespace phat
