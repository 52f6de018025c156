#include "core/dynamic/baker_state.h"

#include <stdexcept>

#include "core/base/parallel.h"
#include "core/phatexel/lookup_tables.h"

namespace phat {
namespace {

// Parts of the photon map, updated one by one.
constexpr size_t kPhotonParts = 16;

void requireUpdatable(const BakeSettings& settings) {
    if (choosesPhotons(settings.directions) || settings.radiance == RadianceSource::photons ||
        settings.radiance == RadianceSource::splat)
        throw std::invalid_argument("PHATexels that are made from single photons cannot be updated");
}

std::vector<uint16_t> scramblesOf(const Atlas& atlas, const BakeSettings& settings, int layer) {
    std::vector<uint16_t> scrambles;
    for (uint32_t block = 0; block < atlas.blockCount; ++block)
        scrambles.push_back(scrambleOf({settings.directions, settings.density, settings.seed, layer}, block));
    return scrambles;
}

}  // namespace

BakerState::BakerState(SharedSnapshot rest, const Atlas& atlas, const TexelPoints& points,
                       const Phatexture& baked, const BakeSettings& wanted)
    : scene(std::move(rest), atlas, points), settings(wanted), phatexture(baked) {
    requireUpdatable(settings);
    updateSceneQueries();
    noIndex.emplace(noPhotons.photons);
    blocks = blockRects(atlas);

    const size_t tiles = atlas.tileChart.size(), texels = atlas.texelCount();
    const bool fresh = phatexture.indirect.empty();
    hasArea = fresh ? lights->hasArea() || settings.dynamic : !phatexture.area.empty();
    if (fresh) {
        phatexture.indirect.resize(size_t(settings.layers));
        for (PhatexelLayer& layer : phatexture.indirect) layer.texels.resize(texels);
        phatexture.indirectIrradiance.assign(texels, 0);
        phatexture.indirectGuides =
            guided() ? std::vector<Guide>(atlas.blockCount, uniformGuide())
                     : std::vector<Guide>{settings.directions == Directions::cosine ? cosineGuide()
                                                                                    : uniformGuide()};
        if (hasArea) {
            phatexture.area.resize(1);
            phatexture.area[0].texels.resize(texels);
            phatexture.areaGuides.assign(atlas.blockCount, uniformGuide());
            phatexture.areaIrradiance.assign(texels, 0);
        }
    }
    settings.layers = int(phatexture.indirect.size());

    for (int layer = 0; layer < settings.layers && fresh; ++layer)
        phatexture.indirect[size_t(layer)].scrambles = scramblesOf(atlas, settings, layer);
    if (fresh && hasArea) phatexture.area[0].scrambles = scramblesOf(atlas, settings, -1);
    if (fresh) {
        SilentProgress silent;
        prepareLookup(phatexture, atlas, scene.points(), scene.frames(), *rays, silent);
    }
    photonsScene.assign(kPhotonParts, 0);
    const glm::uvec2 regions = (atlas.sizeTexels + kBlockSize - 1u) / kBlockSize;
    regionScene.assign(hasArea ? size_t(regions.x) * regions.y : 0, 0);
    regionClock.assign(regionScene.size(), 0);
    tileScene.assign(tiles, scene.version());
    tileClock.assign(tiles, 0);
    blockAge.assign(atlas.blockCount, {});
    for (BlockAge& age : blockAge) age.seed = settings.seed;
    if (!fresh)
        for (BlockAge& age : blockAge)
            age = {scene.version(), scene.version(), irradianceVersion, 0, settings.seed};
    tileDirty.assign(tiles, 0);
    blockDirty.assign(atlas.blockCount, 0);
}

void BakerState::updateSceneQueries() {
    const SceneSnapshot& now = scene.snapshot();
    rays = now.rays();
    lights.emplace(now.scene(), now.rest().environment);
}

uint64_t BakerState::photonsVersion() const {
    return *std::min_element(photonsScene.begin(), photonsScene.end());
}

}  // namespace phat
