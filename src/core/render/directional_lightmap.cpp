#include "core/render/directional_lightmap.h"

#include "core/atlas/dilate.h"
#include "core/atlas/texel_neighbors.h"
#include "core/base/parallel.h"

namespace phat {
namespace {

// What a texel's PHATexels bring.
struct Arriving {
    glm::vec3 towardLight{0};  // world
    glm::vec3 fluxDensity{0};  // of a plane that faces it, in expectation
};

std::vector<Arriving> arrivingLight(const BakedSource& source, const PhatexelLayer& layer, const Atlas& atlas,
                                    const std::vector<Frame>& frames) {
    std::vector<Arriving> arriving(layer.texels.size());
    SilentProgress silent;
    parallelRanges(arriving.size(), 4096, silent, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const glm::uvec2 texel(i % atlas.sizeTexels.x, i / atlas.sizeTexels.x);
            if (atlas.chartAt(texel) == kNoChart) continue;
            const Phatexel phatexel = phatexelAt(layer, source.guides, atlas, texel);
            if (!phatexel.valid || !(phatexel.pdf > 0)) continue;
            arriving[i] = {frames[atlas.blockAt(texel)].toWorld(phatexel.directionBlock),
                           phatexel.radiance / phatexel.pdf};
        }
    });
    return arriving;
}

void addSurroundings(const std::vector<Arriving>& arriving, const Atlas& atlas, const TexelPoints& points,
                     size_t texel, IrradianceTerms& light) {
    const glm::ivec2 size(atlas.sizeTexels), at(int(texel) % size.x, int(texel) / size.x);
    const glm::ivec2 low = glm::max(at - kDirectionReach, glm::ivec2(0)),
                     high = glm::min(at + kDirectionReach, size - 1);
    const uint32_t chart = atlas.chartAt(texel);
    const TexelPlane plane(atlas, points, texel);
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
            const size_t other = size_t(y) * size_t(size.x) + size_t(x);
            if (arriving[other].fluxDensity == glm::vec3(0) || atlas.chartAt(other) != chart) continue;
            if (!plane.has(other, glm::vec2(glm::ivec2(x, y) - at))) continue;
            // A tent: the edges of a box would show as lines where a bright PHATexel enters it.
            const glm::vec2 near = float(kDirectionReach + 1) - glm::abs(glm::vec2(glm::ivec2(x, y) - at));
            light.addLight(texel, arriving[other].towardLight, near.x * near.y * arriving[other].fluxDensity);
        }
}

}  // namespace

void addScaled(const IrradianceTerms& light, const std::vector<glm::vec3>& irradiance,
               const TexelPoints& points, IrradianceTerms& sum) {
    for (size_t i = 0; i < irradiance.size(); ++i) {
        const glm::vec3 facing = light.at(i, points.normal[i]);
        for (int c = 0; c < 3; ++c) {
            // Light from behind its normal would make the scale infinite or negative.
            const bool known = facing[c] > 0.25f * light.term[0][i][c];
            const float scale = known ? irradiance[i][c] / facing[c] : 0;
            for (size_t t = 0; t < 4; ++t) sum.term[t][i][c] += scale * light.term[t][i][c];
            if (!known) sum.term[0][i][c] += irradiance[i][c];
        }
    }
}

void addDirections(const BakedSource& source, const Atlas& atlas, const TexelPoints& points,
                   IrradianceTerms& sum) {
    if (source.irradiance.empty()) return;
    const std::vector<Frame> frames = blockFrames(atlas, points);
    IrradianceTerms light(atlas.texelCount());
    for (const PhatexelLayer& layer : source.layers) {
        const std::vector<Arriving> arriving = arrivingLight(source, layer, atlas, frames);
        SilentProgress silent;
        parallelRanges(arriving.size(), 1024, silent, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i)
                if (points.valid(i)) addSurroundings(arriving, atlas, points, i, light);
        });
    }
    // Gutters behind walls have irradiance of those beside them, too.
    std::vector<uint8_t> directed(atlas.texelCount());
    for (size_t i = 0; i < directed.size(); ++i) directed[i] = light.term[0][i] != glm::vec3(0);
    for (std::vector<glm::vec3>& term : light.term) dilateWithinCharts(term, directed, atlas);
    std::vector<glm::vec3> irradiance;
    irradiance.reserve(source.irradiance.size());
    for (const uint32_t packed : source.irradiance) irradiance.push_back(unpackRgb9e5(packed));
    addScaled(light, irradiance, points, sum);
}

}  // namespace phat
