#include "gl/guide_pass.h"

#include <utility>

#include "gl/guide_tables.h"
#include "gl/textures.h"

namespace phat {
namespace {

using GuideSums = std::array<uint32_t, kGuideCells>;

// twin: shaders/lib/guide_direction.glsl.
GuideSums sumsOf(const Guide& guide) {
    GuideSums sums;
    uint32_t rows = 0, row = 0;
    for (size_t cell = 0; cell < sums.size(); ++cell) {
        if (cell % kGuideSize == 0) rows += std::exchange(row, 0);
        sums[cell] = rows << 16 | row;
        row += guide.weight[cell];
    }
    return sums;
}

// What was drawn for the blocks' guides to their places in a table.
void copyGuides(const GuideTurn& turn, const GlTexture& from, const GlTexture& to, int firstGuide) {
    for (size_t i = 0; i < turn.batch.blocks.size(); ++i) {
        const glm::uvec2 corner = batchCorner(i, kGuideSize);
        const glm::uvec2 place = guideCorner(uint32_t(firstGuide) + turn.batch.blocks[i].block);
        glCopyImageSubData(from.name(), GL_TEXTURE_2D, 0, GLint(corner.x), GLint(corner.y), 0, to.name(),
                           GL_TEXTURE_2D, 0, GLint(place.x), GLint(place.y), 0, kGuideSize, kGuideSize, 1);
    }
}

}  // namespace

GpuGuides uploadGuideSums(const Phatexture& phatexture) {
    std::vector<GuideSums> sums;
    for (const auto* guides : {&phatexture.indirectGuides, &phatexture.areaGuides})
        for (const Guide& guide : *guides) sums.push_back(sumsOf(guide));
    using Cells = std::array<glm::vec2, kGuideCells>;
    const std::vector<Cells> unknown(sums.size(), Cells{});
    return {uploadGuideTables({GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT}, sums),
            uploadGuideTables({GL_RG32F, GL_RG, GL_FLOAT}, unknown)};
}

GuidePass createGuidePass(const std::string& folder) {
    GuidePass pass;
    pass.gather = FullscreenProgram(folder, "gather_guides.frag");
    pass.tabulate = FullscreenProgram(folder, "tabulate_guides.frag");
    const glm::uvec2 size = batchTarget(kGuideSize);
    pass.cells = createTexture2D(GL_RG32F, size);
    pass.sums = createTexture2D(GL_R32UI, size);
    pass.inverseCdfs = createTexture2D(GL_RGBA8, size);
    pass.densities = createTexture2D(GL_R32F, size);
    pass.cellsTarget = createFramebuffer({{pass.cells.name()}});
    pass.tablesTarget =
        createFramebuffer({{pass.sums.name()}, {pass.inverseCdfs.name()}, {pass.densities.name()}});
    return pass;
}

void followGuides(const GuidePass& pass, const GpuGuides& guides, const GuideTurn& turn,
                  const GlTexture& phatexels) {
    const glm::uvec2 size = batchSize(turn.batch.blocks.size(), kGuideSize);
    const ShaderProgram& gather = pass.gather.program;
    gather.bind("phatexels", 0, phatexels.name());
    gather.bind("guideSums", 1, guides.sums.name());
    gather.bind("lastCells", 2, guides.cells.name());
    gather.set("layer", turn.source.firstLayer);
    gather.set("firstGuide", turn.firstGuide);
    turn.batch.set(gather, [&](BlockTurn block) { return uint32_t(turn.scrambles[block.block]); });
    pass.gather.draw(pass.cellsTarget, size);
    copyGuides(turn, pass.cells, guides.cells, turn.firstGuide);
    pass.tabulate.program.bind("cells", 0, pass.cells.name());
    pass.tabulate.draw(pass.tablesTarget, size);
    copyGuides(turn, pass.sums, guides.sums, turn.firstGuide);
}

void showGuides(const GuidePass& pass, const GuideTurn& turn, const GpuLookup& lookup) {
    copyGuides(turn, pass.inverseCdfs, lookup.inverseCdfs, turn.firstGuide);
    copyGuides(turn, pass.densities, turn.source.guidePdf, 0);
}

}  // namespace phat
