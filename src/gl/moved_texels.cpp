// twin: web/src/texel_cover.js, web/src/probe_pass.js.
#include "gl/moved_texels.h"

#include <algorithm>

#include "core/scene/scene_motion.h"
#include "gl/textures.h"

namespace phat {
namespace {

constexpr uint32_t kProbeCells = 16;  // twin: shaders/lib/probe_codes.glsl
// Texels of a block in the tables of levels and of tile patches.
constexpr glm::uvec2 kLevelTexels{2 * kBlockTiles, 4 * kBlockTiles},
    kPatchTexels{2 * kBlockTiles, kBlockTiles};
// Of a block's diagonal: farther above its texels, nothing touches them (kPressedTexels in
// core/atlas/texel_cover.h).
constexpr float kTouchReach = 0.05f;
// A block that begins anew begins with its second round.
constexpr uint32_t kProbeRounds = 2;

bool meet(const Bounds& a, const Bounds& b) {
    return !a.empty() && !b.empty() && glm::all(glm::lessThanEqual(a.low, b.high)) &&
           glm::all(glm::lessThanEqual(b.low, a.high));
}

Bounds reachOf(const Bounds& block) {
    const glm::vec3 margin(kTouchReach * block.diagonal());
    return {block.low - margin, block.high + margin};
}

std::vector<BlockTurn> partOf(const TexelBatch& batch, const std::vector<uint8_t>& stale,
                              uint32_t minRounds) {
    std::vector<BlockTurn> part;
    std::copy_if(batch.blocks.begin(), batch.blocks.end(), std::back_inserter(part),
                 [&](const BlockTurn& turn) { return stale[turn.block] && turn.rounds >= minRounds; });
    return part;
}

void markFresh(std::vector<uint8_t>& stale, const std::vector<BlockTurn>& part) {
    for (const BlockTurn& turn : part) stale[turn.block] = 0;
}

uint32_t noScramble(BlockTurn) {
    return 0;
}

// What was drawn for each block, `texels` of a block of full size, to its place in a table.
void copyBlocks(const TexelBatch& batch, glm::uvec2 texels, const GlTexture& from, const GlTexture& to) {
    for (size_t i = 0; i < batch.blocks.size(); ++i) {
        const BlockRect& rect = batch.rects[batch.blocks[i].block];
        const glm::uvec2 corner = glm::uvec2(i % kBatchSide, i / kBatchSide) * texels,
                         place = rect.origin * texels / kBlockSize, size = rect.size * texels / kBlockSize;
        glCopyImageSubData(from.name(), GL_TEXTURE_2D, 0, GLint(corner.x), GLint(corner.y), 0, to.name(),
                           GL_TEXTURE_2D, 0, GLint(place.x), GLint(place.y), 0, GLsizei(size.x),
                           GLsizei(size.y), 1);
    }
}

glm::uvec2 sizeOf(const TexelBatch& batch, glm::uvec2 texels) {
    return {batchSize(batch.blocks.size(), texels.x).x, batchSize(batch.blocks.size(), texels.y).y};
}

void coverTexels(const MovedTexelsPass& pass, const GpuTexelPoints& points, const LitWorld& world,
                 const TexelBatch& batch) {
    const ShaderProgram& program = pass.cover.program;
    bindBvh(world.rays.bvh, program, 0);
    bindTexelPoints(points, world.atlas, program, kBvhUnits);
    // As if nothing were covered.
    program.bind("texelNormals", kBvhUnits + 1, points.restNormals.name());
    bindHits(world.rays.hits, program, kBvhUnits + kTexelPointUnits);
    program.set("originUnitMeters", world.atlas.unitMeters);
    batch.set(program, noScramble);
    pass.cover.draw(pass.normalsTarget, batch.size());
    copyBlocks(batch, glm::uvec2(kBlockSize), pass.normals, points.normals);
}

void traceProbes(const MovedTexelsPass& pass, const GpuTexelPoints& points, const LitWorld& world,
                 const TexelBatch& batch) {
    const ShaderProgram& program = pass.traceProbes.program;
    bindBvh(world.rays.bvh, program, 0);
    bindTexelPoints(points, world.atlas, program, kBvhUnits);
    program.bind("tilePatches", kBvhUnits + kTexelPointUnits, world.atlas.tilePatches.name());
    program.set("unitMeters", world.atlas.unitMeters);
    program.set("originUnitMeters", world.atlas.unitMeters);
    batch.set(program, noScramble);
    pass.traceProbes.draw(pass.codesTarget, sizeOf(batch, glm::uvec2(kBlockTiles * kProbeCells)));

    const ShaderProgram& levels = pass.packProbes.program;
    levels.bind("distanceCodes", 0, pass.codes.name());
    batch.set(levels, noScramble);
    pass.packProbes.draw(pass.levelsTarget, sizeOf(batch, kLevelTexels));
    copyBlocks(batch, kLevelTexels, pass.levels, world.lookup.probes);

    const ShaderProgram& ranges = pass.packRanges.program;
    ranges.bind("distanceCodes", 0, pass.codes.name());
    ranges.bind("tilePatches", 1, world.atlas.tilePatches.name());
    batch.set(ranges, noScramble);
    pass.packRanges.draw(pass.patchesTarget, sizeOf(batch, kPatchTexels));
    copyBlocks(batch, kPatchTexels, pass.patches, world.atlas.tilePatches);
}

}  // namespace

MovedTexels createMovedTexels(const Scene& rest, const Atlas& atlas, const TexelPoints& points) {
    MovedTexels moved;
    moved.nodeBounds.resize(rest.nodes.size());
    for (const Surface& surface : rest.surfaces) {
        if (surface.node >= moved.nodeBounds.size()) moved.nodeBounds.resize(surface.node + 1);
        moved.nodeBounds[surface.node] = boundsOfNode(rest, surface.node);
    }
    for (const BlockRect& rect : blockRects(atlas)) {
        Bounds bounds;
        for (uint32_t y = rect.origin.y; y < rect.origin.y + rect.size.y; ++y)
            for (uint32_t x = rect.origin.x; x < rect.origin.x + rect.size.x; ++x) {
                const size_t texel = size_t(y) * atlas.sizeTexels.x + x;
                if (mayBeCovered(points, texel)) bounds.add(points.position[texel]);
            }
        moved.blockBounds.push_back(bounds);
        moved.blockNode.push_back(rest.surfaces[atlas.charts[atlas.chartAt(rect.origin)].surface].node);
    }
    moved.staleCover.resize(moved.blockBounds.size());
    moved.staleProbes.resize(moved.blockBounds.size());
    return moved;
}

void noteMotion(MovedTexels& moved, const Scene& now, std::span<const glm::mat4> worldFromRest) {
    std::vector<uint8_t> nodeMoves(moved.nodeBounds.size(), 0);
    std::vector<Bounds> boxes;
    for (uint32_t node = 0; node < nodeMoves.size(); ++node) {
        if (matrixAt(worldFromRest, node) == matrixAt(moved.worldFromRest, node)) continue;
        if (moved.nodeBounds[node].empty()) continue;
        nodeMoves[node] = 1;
        boxes.push_back(moved.nodeBounds[node]);
        boxes.push_back(moved.nodeBounds[node] = boundsOfNode(now, node));
    }
    moved.worldFromRest.assign(worldFromRest.begin(), worldFromRest.end());
    if (boxes.empty()) return;
    std::fill(moved.staleProbes.begin(), moved.staleProbes.end(), uint8_t(1));
    for (size_t block = 0; block < moved.blockBounds.size(); ++block) {
        if (moved.blockBounds[block].empty()) continue;
        const bool moves = nodeMoves[moved.blockNode[block]] != 0;
        // Where it was moved earlier, its own box says where it is.
        const Bounds& own = matrixAt(worldFromRest, moved.blockNode[block]) == glm::mat4(1)
                                ? moved.blockBounds[block]
                                : moved.nodeBounds[moved.blockNode[block]];
        const Bounds reach = reachOf(own);
        if (moves ||
            std::any_of(boxes.begin(), boxes.end(), [&](const Bounds& box) { return meet(reach, box); }))
            moved.staleCover[block] = 1;
    }
}

MovedTexelsPass createMovedTexelsPass(const std::string& folder, const std::vector<std::string>& bvhDefines) {
    MovedTexelsPass pass;
    pass.cover = FullscreenProgram(folder, "cover_texels.frag", bvhDefines);
    pass.traceProbes = FullscreenProgram(folder, "trace_probes.frag", bvhDefines);
    pass.packProbes = FullscreenProgram(folder, "pack_probes.frag");
    pass.packRanges = FullscreenProgram(folder, "pack_probes.frag", {"RANGE"});
    pass.normals = createTexture2D(GL_R32UI, batchTarget(kBlockSize));
    pass.codes = createTexture2D(GL_R8UI, batchTarget(kBlockTiles * kProbeCells));
    pass.levels = createTexture2D(GL_RGBA32UI, kBatchSide * kLevelTexels);
    pass.patches = createTexture2D(GL_RGBA32UI, kBatchSide * kPatchTexels);
    pass.normalsTarget = createFramebuffer({{pass.normals.name()}});
    pass.codesTarget = createFramebuffer({{pass.codes.name()}});
    pass.levelsTarget = createFramebuffer({{pass.levels.name()}});
    pass.patchesTarget = createFramebuffer({{pass.patches.name()}});
    return pass;
}

void updateMovedTexels(const MovedTexelsPass& pass, MovedTexels& moved, const GpuTexelPoints& points,
                       const LitWorld& world, const TexelBatch& batch) {
    const std::vector<BlockTurn> covers = partOf(batch, moved.staleCover, 0);
    if (!covers.empty()) coverTexels(pass, points, world, {batch.rects, covers});
    markFresh(moved.staleCover, covers);
    const std::vector<BlockTurn> probes = partOf(batch, moved.staleProbes, kProbeRounds);
    if (!probes.empty()) traceProbes(pass, points, world, {batch.rects, probes});
    markFresh(moved.staleProbes, probes);
}

}  // namespace phat
