// What the GPU makes anew of texels and tiles where something has moved, against the baker.

#include "gl/moved_texels.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "core/bake/bake.h"
#include "core/dynamic/incremental_baker.h"
#include "core/phatexel/lookup_tables.h"
#include "gl/gl_context.h"
#include "gl/light_world.h"

namespace phat::test {
namespace {

constexpr uint32_t kCovered = 0x80008001u;  // twin: shaders/lib/texel_point.glsl

// A box on a floor, which moves by more than its width.
struct MovedBox {
    MovedBox() {
        addRoom(scene, lambert(0.5f), {1, 1, 1});
        addOutwardBox(scene, lambert(0.3f), {0.1f, 0, 0.35f}, {0.3f, 0.3f, 0.3f});
        for (size_t i = 6; i < scene.surfaces.size(); ++i) scene.surfaces[i].node = 1;
        scene.nodes.resize(2);
        addQuad(scene, emitter(glm::vec3(8)), {0.4f, 0.98f, 0.4f}, {0.2f, 0, 0}, {0, 0, 0.2f});
        settings.atlas.texelBudget = 12'000;
        settings.photons.count = 2'000;
        settings.pathsPerPhatexel = 1;
        baked = bake(scene, settings, progress);
        worldFromRest = {glm::mat4(1), glm::translate(glm::mat4(1), {0.4f, 0, 0.1f})};
        PosedScene posed(scene);
        engine.emplace(posed.snapshot(), baked.atlas, baked.points, baked.phatexture, settings);
        posed.setState({worldFromRest, scene.lights, scene.materials});
        engine->setScene(posed.snapshot());
        engine->converge(progress);
    }

    Scene scene;
    BakeSettings settings;
    SilentProgress progress;
    Bake baked;
    std::vector<glm::mat4> worldFromRest;
    std::optional<IncrementalBaker> engine;  // of the moved scene
};

/// What the GPU has after `rounds` rounds of all blocks.
struct Result {
    std::vector<uint32_t> normals;
    std::vector<glm::uvec4> levels, patches;
};

template <typename Word>
std::vector<Word> wordsOf(const GlTexture& texture, glm::uvec2 size, GLenum format) {
    std::vector<Word> words(size_t(size.x) * size.y);
    glGetTextureImage(texture.name(), 0, format, GL_UNSIGNED_INT, GLsizei(words.size() * sizeof(Word)),
                      words.data());
    return words;
}

Result movedOnGpu(const MovedBox& box) {
    const HeadlessContext context;
    const Atlas& atlas = box.baked.atlas;
    const Scene& now = box.engine->scene().scene();
    const SceneBvh bvh = buildSceneBvh(box.scene);
    GpuRayScene rays{uploadBvh(now, bvh), uploadHits(now, atlas, bvh), {}};
    moveBvh(rays.bvh, poseBvh(bvh, box.worldFromRest));
    // Tiles are moved by the baker, with the probes that they have had.
    Phatexture before = box.baked.phatexture;
    for (size_t tile = 0; tile < atlas.tileChart.size(); ++tile) {
        const uint32_t range = ((1u << 12) - 1) << 19;
        const uint32_t baked = before.tilePatches[tile][0].w;
        before.tilePatches[tile] = box.engine->phatexture().tilePatches[tile];
        uint32_t& words = before.tilePatches[tile][0].w;
        words = (words & ~range) | (baked & range);
    }
    const GpuAtlas gpuAtlas = uploadAtlas(now, atlas, before);
    const GpuLookup lookup = uploadLookup(before, atlas);
    const GpuScene surfaces = uploadScene(now, atlas);
    const ShadowMaps shadows;
    const LitWorld world{rays, gpuAtlas, lookup, surfaces, shadows};
    GpuTexelPoints points = uploadTexelPoints(box.scene, atlas, box.baked.points);
    moveTexelPoints(points, now, atlas, box.worldFromRest);
    MovedTexels moved = createMovedTexels(box.scene, atlas, box.baked.points);
    noteMotion(moved, now, box.worldFromRest);
    const MovedTexelsPass pass = createMovedTexelsPass(PHAT_SOURCE_DIR "/shaders", bvhDefines(bvh));
    const std::vector<BlockRect> rects = blockRects(atlas);
    const std::vector<BlockTurn> turns = turnsOf(atlas, 2);
    for (size_t first = 0; first < turns.size(); first += kBatchBlocks)
        updateMovedTexels(
            pass, moved, points, world,
            {rects, std::span(turns).subspan(first, std::min<size_t>(kBatchBlocks, turns.size() - first))});
    const glm::uvec2 tiles = atlas.sizeTiles();
    return {wordsOf<uint32_t>(points.normals, atlas.sizeTexels, GL_RED_INTEGER),
            wordsOf<glm::uvec4>(lookup.probes, tiles * glm::uvec2(2, 4), GL_RGBA_INTEGER),
            wordsOf<glm::uvec4>(gpuAtlas.tilePatches, tiles * glm::uvec2(2, 1), GL_RGBA_INTEGER)};
}

TEST(MovedTexels, AreCoveredAndProbedAsTheBakerSays) {
    const MovedBox box;
    const Result gpu = movedOnGpu(box);
    const Atlas& atlas = box.baked.atlas;
    const TexelPoints &before = box.baked.points, &after = box.engine->scene().points();
    int changed = 0, wrong = 0;
    for (size_t i = 0; i < gpu.normals.size(); ++i) {
        const glm::vec2 b = before.barycentric[i];
        if (before.triangle[i] == kNoTriangle || b.x < 0 || b.y < 0 || b.x + b.y > 1) continue;
        changed += before.valid(i) != after.valid(i);
        wrong += after.valid(i) != (gpu.normals[i] != kCovered);
    }
    // The two draw other random numbers: texels at the border of a contact are covered by chance.
    EXPECT_GT(changed, 100);
    EXPECT_LT(wrong, 0.1 * changed);

    const Phatexture& expected = box.engine->phatexture();
    int cells = 0, staleCells = 0, wrongCells = 0;
    for (uint32_t tile = 0; tile < atlas.tileChart.size(); ++tile) {
        const glm::uvec2 at(tile % atlas.sizeTiles().x, tile / atlas.sizeTiles().x);
        const uint32_t word = expected.tilePatches[tile][0].w;
        if (atlas.tileChart[tile] == kNoChart || (word >> 18 & 1) == 0) continue;
        DepthProbe found;
        const uint32_t range = gpu.patches[at.y * 2 * size_t(atlas.sizeTiles().x) + 2 * at.x].w;
        found.low = range >> 19 & 63;
        found.high = range >> 25 & 63;
        for (uint32_t cell = 0; cell < kProbeSize * kProbeSize; ++cell) {
            const uint32_t x = cell % kProbeSize, y = cell / kProbeSize;
            const glm::uvec2 texel = at * glm::uvec2(2, 4) + glm::uvec2(x / 8, y / 4);
            const glm::uvec4& levels = gpu.levels[size_t(texel.y) * 2 * atlas.sizeTiles().x + texel.x];
            const auto codeOf = [&](const DepthProbe& probe, uint32_t level) {
                return int(packDistance(probeDistance(probe, level, atlas.unitMeters), atlas.unitMeters));
            };
            const DepthProbe &want = expected.probes[tile], &old = box.baked.phatexture.probes[tile];
            const int code = codeOf(want, want.level[cell]);
            // Half an octave, which is more than a level here.
            const auto isOff = [&](int other) { return std::abs(other - code) > 6; };
            ++cells;
            staleCells += isOff(codeOf(old, old.level[cell]));
            wrongCells += isOff(codeOf(found, levels[int(y % 4)] >> (4 * (x % 8)) & 15));
        }
    }
    EXPECT_GT(staleCells, cells / 50);
    // Rays that graze an edge.
    EXPECT_LT(wrongCells, cells / 500);
}

}  // namespace
}  // namespace phat::test
