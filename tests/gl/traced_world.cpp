#include "gl/traced_world.h"

#include "core/phatexel/lookup_tables.h"

namespace phat::test {
namespace {

// PHATexels in the baked order, which is what can be looked up; the same radiance from everywhere.
PhatexelLayer layerOf(const RendererWorld& world, float radiance) {
    PhatexelLayer layer;
    layer.texels.resize(world.atlas.texelCount());
    layer.scrambles.assign(world.atlas.blockCount, 0);
    for (uint32_t y = 0; y < world.atlas.sizeTexels.y; ++y) {
        for (uint32_t x = 0; x < world.atlas.sizeTexels.x; ++x) {
            const glm::uvec2 inBlock =
                (glm::uvec2(x, y) - world.atlas.charts[world.atlas.chartAt({x, y})].originTexel()) %
                kBlockSize;
            const glm::uvec2 cell = mortonDecode(reverseBits(morton(inBlock.x, inBlock.y), 10));
            Phatexel phatexel;
            phatexel.directionBlock =
                squareToGuide(world.phatexture.indirectGuides[world.atlas.blockAt({x, y})],
                              (glm::vec2(cell) + 0.5f) / float(kBlockSize));
            phatexel.radiance = glm::vec3(radiance);
            phatexel.distance = 2;
            phatexel.valid = true;
            layer.texels[size_t(y) * world.atlas.sizeTexels.x + x] = packPhatexel(phatexel, 1);
        }
    }
    return layer;
}

}  // namespace

void setIrradiance(RendererWorld& world, uint32_t surface, float wattsPerSquareMeter) {
    for (uint32_t y = 0; y < world.atlas.sizeTexels.y; ++y)
        for (uint32_t x = 0; x < world.atlas.sizeTexels.x; ++x)
            if (world.atlas.chartAt({x, y}) == surface)
                world.phatexture.indirectIrradiance[size_t(y) * world.atlas.sizeTexels.x + x] =
                    packRgb9e5(glm::vec3(wattsPerSquareMeter));
}

void fillWithLookups(RendererWorld& world, float indirect, float area) {
    world.phatexture.indirect = {layerOf(world, indirect)};
    world.phatexture.area = {layerOf(world, area)};
    world.phatexture.areaGuides = world.phatexture.indirectGuides;
    world.phatexture.areaIrradiance.assign(world.atlas.texelCount(), packRgb9e5(glm::vec3(kPi * area)));
    SilentProgress silent;
    prepareLookup(world.phatexture, world.atlas, world.points, blockFrames(world.atlas, world.points),
                  RayScene(world.scene), silent);
}

}  // namespace phat::test
