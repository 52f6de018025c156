// What the rays of PHATexels see reflected where they end, against walks by the CPU from the same hits.

#include <gtest/gtest.h>

#include "core/bake/bake.h"
#include "core/bake/irradiance_ray.h"
#include "core/base/parallel.h"
#include "core/scene/shading.h"
#include "gl/traced_world.h"

namespace phat::test {
namespace {

Material dielectric(float albedo) {
    Material material = lambert(albedo);
    material.specular = 1;
    return material;
}

/// A lamp under the ceiling of a room, beside its own case, over a mirror-like table and a rough metal box.
struct LampRoom {
    enum Kind : uint8_t { walls, lampCase, table, box };

    LampRoom() {
        add(walls, [&] { addRoom(scene, dielectric(0.6f), {1, 1, 1}); });
        add(lampCase, [&] {
            addQuad(scene, dielectric(0.5f), {0.38f, 0.9f, 0.38f}, {0.24f, 0, 0}, {0, 0.08f, 0});
        });
        add(table, [&] {
            Material gloss = whiteMetal(0.25f);
            gloss.baseColor = glm::vec4(0.8f, 0.8f, 0.8f, 1);
            addQuad(scene, gloss, {0.1f, 0.2f, 0.1f}, {0, 0, 0.8f}, {0.8f, 0, 0});
        });
        add(box, [&] { addOutwardBox(scene, whiteMetal(0.6f), {0.6f, 0.25f, 0.5f}, {0.2f, 0.2f, 0.2f}); });
        add(walls, [&] {
            addQuad(scene, emitter(glm::vec3(8)), {0.4f, 0.95f, 0.4f}, {0.2f, 0, 0}, {0, 0, 0.2f});
        });
        BakeSettings settings;
        settings.atlas.texelBudget = 30'000;
        settings.photons.count = 40'000;
        settings.pathsPerPhatexel = 1;
        SilentProgress progress;
        baked = bake(scene, settings, progress);
    }
    template <typename Add>
    void add(Kind kind, const Add& addSurfaces) {
        addSurfaces();
        kinds.resize(scene.surfaces.size(), kind);
    }

    Scene scene;
    std::vector<Kind> kinds;  // [surface]
    Bake baked;
};

/// The ends of the rays of the indirect light's PHATexels, and the radiance that arrives from there.
struct SeenHit {
    bool counts = false;
    LampRoom::Kind kind{};
    double reflected = 0, pdf = 0;  // luminance
};

std::vector<SeenHit> hitsByTheCpu(const LampRoom& room) {
    const Bake& baked = room.baked;
    const RayScene rays(room.scene);
    const LightSampler lights(room.scene);
    const std::vector<Frame> frames = blockFrames(baked.atlas, baked.points);
    const std::vector<uint8_t> receives = irradianceTexels(baked.atlas, baked.points);
    const TexelWorld world{{rays, lights}, baked.atlas, baked.points, receives};
    const TexelIrradiance irradiance{baked.phatexture.indirectIrradiance, baked.phatexture.areaIrradiance,
                                     true};
    std::vector<SeenHit> seen(baked.atlas.texelCount());
    SilentProgress progress;
    parallelRanges(seen.size(), 256, progress, [&](size_t begin, size_t end) {
        for (size_t texel = begin; texel < end; ++texel) {
            if (baked.points.state[texel] != TexelState::surface) continue;
            const glm::uvec2 xy(texel % baked.atlas.sizeTexels.x, texel / baked.atlas.sizeTexels.x);
            const Phatexel phatexel =
                phatexelAt(baked.phatexture.indirect[0], baked.phatexture.indirectGuides, baked.atlas, xy);
            if (!phatexel.valid) continue;
            const glm::vec3 direction = frames[baked.atlas.blockAt(xy)].toWorld(phatexel.directionBlock);
            const glm::vec3 flat = flatNormalOf(room.scene, baked.atlas, baked.points, texel);
            const Hit hit = rays.closestHit(rays.offsetOrigin(baked.points.position[texel], flat), direction);
            if (!hit) continue;
            const SurfacePoint point = surfaceAt(room.scene, hit, direction);
            Rng rng(hashOf(11, texel));
            uint64_t rayCount = 0;
            const glm::vec3 reflected =
                reflectedFromTexels(world, irradiance, {hit, point, -direction}, {64, 8}, rng, rayCount)
                    .sum();
            seen[texel] = {true, room.kinds[room.scene.triangleSurface[hit.triangle]],
                           double(luminance(reflected)), double(phatexel.pdf)};
        }
    });
    return seen;
}

// By kind of surface: rough dielectrics, the same where lamps are near, and metals.
TEST(GpuHits, ReflectWhatWalksFind) {
    const LampRoom room;
    const Bake& baked = room.baked;
    const std::vector<SeenHit> seen = hitsByTheCpu(room);
    const SceneBvh bvh = buildSceneBvh(room.scene);
    const RendererInput input{room.scene, baked.atlas, baked.points, baked.phatexture, &bvh};
    const HeadlessContext context;
    std::vector<BlockTurn> blocks;
    for (uint32_t block = 0; block < baked.atlas.blockCount; ++block) blocks.push_back({block, 0});
    struct Sums {
        double found = 0, expected = 0, squares = 0;
    };
    std::array<Sums, 4> sums;
    Sums all;
    for (uint32_t round = 1; round <= 24; ++round) {
        Renderer renderer(input, kShaderFolder);  // from the bake's PHATexels each time
        renderer.beginLight(input);
        renderer.traceLight({.blocks = blocks, .number = round, .irradiance = false});
        const StoredLight light = renderer.readLight();
        for (size_t texel = 0; texel < seen.size(); ++texel) {
            if (!seen[texel].counts) continue;
            const Phatexel phatexel = unpackPhatexel(light.phatexels[0][texel], baked.atlas.unitMeters);
            const double found = double(luminance(phatexel.radiance)) / seen[texel].pdf;
            const double expected = seen[texel].reflected / seen[texel].pdf;
            for (Sums* s : {&sums[seen[texel].kind], &all}) {
                s->found += found;
                s->expected += expected;
                s->squares += square(found - expected);
            }
        }
    }
    const auto ratio = [](const Sums& s) { return s.found / s.expected; };
    const auto noise = [](const Sums& s) { return std::sqrt(s.squares) / s.expected; };
    // The means over eight points of a lamp that is near are not quite those over all of it.
    EXPECT_NEAR(ratio(sums[LampRoom::walls]), 1, 0.003);
    EXPECT_NEAR(ratio(sums[LampRoom::lampCase]), 1, 0.02);
    // Cells of a few degrees show a lamp in a mirror as wide as they are: not all of it is on the table then.
    EXPECT_NEAR(ratio(sums[LampRoom::table]), 1, 0.1);
    EXPECT_NEAR(ratio(sums[LampRoom::box]), 1, 0.1);
    EXPECT_NEAR(ratio(all), 1, 0.005 + 2 * noise(all));
    EXPECT_LT(noise(all), 0.003);
}

}  // namespace
}  // namespace phat::test
