#include "core/phatexel/radiance_bound.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>

#include "core/scene/light_bound.h"

namespace phat {
namespace {

// The widest cone, kMaxRadius = 24 texels in shaders/lib/cone.glsl, reaches three tiles far.
constexpr int kNeighborTiles = 3;

struct TileSums {
    float lit = 0, all = 0;          // sums of 1 / pdf over the area lights' PHATexels, steradians
    glm::vec3 area{0}, indirect{0};  // the brightest
};

TileSums sumTile(const Atlas& atlas, const Phatexture& phatexture, glm::uvec2 tile) {
    TileSums sums;
    for (uint32_t i = 0; i < kTileSize * kTileSize; ++i) {
        const glm::uvec2 texel = tile * kTileSize + glm::uvec2(i % kTileSize, i / kTileSize);
        for (const PhatexelLayer& layer : phatexture.indirect)
            sums.indirect = glm::max(
                sums.indirect,
                unpackPhatexel(layer.texels[size_t(texel.y) * atlas.sizeTexels.x + texel.x], atlas.unitMeters)
                    .radiance);
        for (const PhatexelLayer& layer : phatexture.area) {
            const Phatexel phatexel = phatexelAt(layer, phatexture.areaGuides, atlas, texel);
            if (!phatexel.valid || !(phatexel.pdf > 0)) continue;
            sums.all += 1.0f / phatexel.pdf;
            if (phatexel.radiance != glm::vec3(0)) sums.lit += 1.0f / phatexel.pdf;
            sums.area = glm::max(sums.area, phatexel.radiance);
        }
    }
    return sums;
}

// See brightestRadiance; the brightest area PHATexel gives the same bound, or a lower one where emission is
// textured. Without it the noise of the brightest indirect PHATexels would be taken for light.
glm::vec3 brightestOfScene(const Scene& scene, const std::vector<TileSums>& sums) {
    glm::vec3 brightest(0);
    for (const TileSums& tile : sums) brightest = glm::max(brightest, tile.area);
    if (!scene.lights.empty() || emittersReflect(scene) || brightest == glm::vec3(0))
        return glm::vec3(kUnbounded);
    return brightest;
}

}  // namespace

std::vector<glm::vec4> tileLight(const Scene& scene, const Atlas& atlas, const Phatexture& phatexture) {
    const glm::ivec2 size(atlas.sizeTiles());
    const auto forTiles = [&](const auto& body) {
        oneapi::tbb::parallel_for(0, size.y, [&](int y) {
            for (int x = 0; x < size.x; ++x) {
                const size_t tile = size_t(y) * size_t(size.x) + size_t(x);
                if (atlas.tileChart[tile] != kNoChart) body(tile, x, y);
            }
        });
    };
    std::vector<TileSums> sums(atlas.tileChart.size());
    forTiles([&](size_t tile, int x, int y) { sums[tile] = sumTile(atlas, phatexture, {x, y}); });

    const bool both = emittersReflect(scene);
    const glm::vec3 bound = brightestOfScene(scene, sums);
    std::vector<glm::vec4> light(sums.size(), glm::vec4(0));
    forTiles([&](size_t tile, int x, int y) {
        TileSums around;
        for (int ny = std::max(y - kNeighborTiles, 0); ny <= std::min(y + kNeighborTiles, size.y - 1); ++ny) {
            for (int nx = std::max(x - kNeighborTiles, 0); nx <= std::min(x + kNeighborTiles, size.x - 1);
                 ++nx) {
                const size_t neighbor = size_t(ny) * size_t(size.x) + size_t(nx);
                if (atlas.tileChart[neighbor] != atlas.tileChart[tile]) continue;
                around.lit += sums[neighbor].lit;
                around.all += sums[neighbor].all;
                around.area = glm::max(around.area, sums[neighbor].area);
                around.indirect = glm::max(around.indirect, sums[neighbor].indirect);
            }
        }
        const glm::vec3 brightest =
            both ? around.area + around.indirect : glm::max(around.area, around.indirect);
        light[tile] = glm::vec4(glm::min(brightest, bound), around.all > 0 ? around.lit / around.all : 0.0f);
    });
    return light;
}

}  // namespace phat
