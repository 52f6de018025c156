#include "gl/renderer_world.h"

#include <glm/gtc/matrix_transform.hpp>

#include "core/phatexel/lookup_tables.h"

namespace phat::test {
namespace {

constexpr float kGutter = 4;

void addChart(RendererWorld& world, uint32_t surfaceIndex, uint32_t tiles) {
    const Surface& surface = world.scene.surfaces[surfaceIndex];
    Chart chart;
    chart.originTile = {surfaceIndex * tiles, 0};
    chart.sizeTiles = glm::uvec2(tiles);
    const glm::uvec3 first = world.scene.triangles[surface.firstTriangle];
    const float side = glm::distance(world.scene.positions[first.x], world.scene.positions[first.y]);
    const float inner = float(tiles * kTileSize) - 2 * kGutter;
    chart.texelSizeMeters = side / inner;
    chart.surface = surfaceIndex;
    world.atlas.texelSizeMeters = std::max(world.atlas.texelSizeMeters, chart.texelSizeMeters);
    world.atlas.charts.push_back(chart);
    const glm::vec2 low = glm::vec2(chart.originTexel()) + kGutter;
    for (uint32_t t = 0; t < surface.triangleCount; ++t) {
        const glm::uvec3 triangle = world.scene.triangles[surface.firstTriangle + t];
        world.atlas.triangleChart.push_back(surfaceIndex);
        world.atlas.triangleSurface.push_back(surfaceIndex);
        auto& texels = world.atlas.triangleTexels.emplace_back();
        for (int corner = 0; corner < 3; ++corner)
            texels[corner] = low + inner * world.scene.uv0[triangle[corner]];
    }
}

void addPoints(RendererWorld& world, uint32_t surfaceIndex, uint32_t tiles) {
    const Surface& surface = world.scene.surfaces[surfaceIndex];
    const glm::uvec3 triangle = world.scene.triangles[surface.firstTriangle];
    const auto& positions = world.scene.positions;
    const glm::vec3 along = positions[triangle.y] - positions[triangle.x];
    const glm::vec3 across = positions[triangle.z] - positions[triangle.y];
    const glm::vec2 origin(world.atlas.charts[surfaceIndex].originTexel());
    const float inner = float(tiles * kTileSize) - 2 * kGutter;
    for (uint32_t y = 0; y < tiles * kTileSize; ++y) {
        for (uint32_t x = 0; x < tiles * kTileSize; ++x) {
            const size_t texel = (size_t(origin.y) + y) * world.atlas.sizeTexels.x + size_t(origin.x) + x;
            const glm::vec2 uv = (glm::vec2(x, y) + 0.5f - kGutter) / inner;
            const bool inside = uv.x >= 0 && uv.y >= 0 && uv.x <= 1 && uv.y <= 1;
            TexelPoints& points = world.points;
            points.state[texel] = inside ? TexelState::surface : TexelState::gutter;
            points.position[texel] = positions[triangle.x] + uv.x * along + uv.y * across;
            points.normal[texel] = world.scene.normals[triangle.x];
            points.tangent[texel] = glm::normalize(along);
            points.triangle[texel] = surface.firstTriangle;
            points.barycentric[texel] = {uv.x - uv.y, uv.y};
        }
    }
}

}  // namespace

RendererWorld worldOfQuads(Scene scene, uint32_t tiles) {
    RendererWorld world;
    world.scene = std::move(scene);
    const uint32_t count = uint32_t(world.scene.surfaces.size());
    Atlas& atlas = world.atlas;
    atlas.sizeTexels = glm::uvec2(count * tiles, tiles) * kTileSize;
    for (uint32_t s = 0; s < count; ++s) addChart(world, s, tiles);
    atlas.tileChart.resize(size_t(count) * tiles * tiles);
    for (uint32_t y = 0; y < tiles; ++y)
        for (uint32_t x = 0; x < count * tiles; ++x)
            atlas.tileChart[size_t(y) * count * tiles + x] = x / tiles;
    numberBlocks(atlas);

    const size_t texels = atlas.texelCount();
    world.points.sizeTexels = atlas.sizeTexels;
    world.points.state.resize(texels);
    world.points.position.resize(texels);
    world.points.normal.resize(texels);
    world.points.tangent.resize(texels);
    world.points.triangle.resize(texels);
    world.points.barycentric.resize(texels);
    for (uint32_t s = 0; s < count; ++s) addPoints(world, s, tiles);
    world.phatexture.indirect.resize(1);
    world.phatexture.indirect[0].texels.resize(texels);
    for (uint32_t b = 0; b < atlas.blockCount; ++b) world.phatexture.indirectGuides.push_back(bumpyGuide(b));
    world.phatexture.indirectIrradiance.assign(texels, 0);
    prepareLookup(world);
    return world;
}

void prepareLookup(RendererWorld& world) {
    SilentProgress silent;
    prepareLookup(world.phatexture, world.atlas, world.points, blockFrames(world.atlas, world.points),
                  RayScene(world.scene), silent);
}

void fillPhatexels(RendererWorld& world, uint32_t surface, const LightAt& light, float distance) {
    const std::vector<Frame> frames = blockFrames(world.atlas, world.points);
    Rng random(surface);
    for (uint32_t y = 0; y < world.atlas.sizeTexels.y; ++y) {
        for (uint32_t x = 0; x < world.atlas.sizeTexels.x; ++x) {
            if (world.atlas.chartAt({x, y}) != surface) continue;
            const size_t texel = size_t(y) * world.atlas.sizeTexels.x + x;
            const uint32_t block = world.atlas.blockAt({x, y});
            Phatexel phatexel;
            phatexel.directionBlock =
                squareToGuide(world.phatexture.indirectGuides[block], random.uniform2());
            phatexel.radiance =
                light(world.points.position[texel], frames[block].toWorld(phatexel.directionBlock));
            phatexel.distance = distance;
            phatexel.valid = true;
            world.phatexture.indirect[0].texels[texel] = packPhatexel(phatexel, 1);
        }
    }
}

PhatexelLayer layerInBakedOrder(const RendererWorld& world, const LightAt& light, float distance) {
    const std::vector<Frame> frames = blockFrames(world.atlas, world.points);
    PhatexelLayer layer;
    layer.texels.resize(world.atlas.texelCount());
    layer.scrambles.assign(world.atlas.blockCount, 0);
    for (uint32_t y = 0; y < world.atlas.sizeTexels.y; ++y) {
        for (uint32_t x = 0; x < world.atlas.sizeTexels.x; ++x) {
            const glm::uvec2 corner = world.atlas.charts[world.atlas.chartAt({x, y})].originTexel();
            const glm::uvec2 inBlock = (glm::uvec2(x, y) - corner) % kBlockSize;
            const uint32_t block = world.atlas.blockAt({x, y});
            const size_t texel = size_t(y) * world.atlas.sizeTexels.x + x;
            Phatexel phatexel;
            phatexel.directionBlock = squareToGuide(world.phatexture.indirectGuides[block],
                                                    stratifiedSquare(inBlock, 0, glm::vec2(0.5f)));
            phatexel.radiance =
                light(world.points.position[texel], frames[block].toWorld(phatexel.directionBlock));
            phatexel.distance = distance;
            phatexel.valid = true;
            layer.texels[texel] = packPhatexel(phatexel, 1);
        }
    }
    return layer;
}

Material metal(float roughness) {
    Material material;
    material.baseColor = {0.9f, 0.6f, 0.3f, 1};
    material.metallic = 1;
    material.roughness = roughness;
    return material;
}

Guide bumpyGuide(uint64_t seed) {
    std::array<float, kGuideCells> cells;
    Rng random(hashOf(seed, 77));
    for (float& cell : cells) cell = 1 + 7 * random.uniform();
    return makeGuide(cells, 0);
}

Camera lookAtCamera(glm::vec3 eye, glm::vec3 target, float yfovDegrees) {
    const glm::vec3 up =
        std::abs(glm::normalize(target - eye).y) < 0.99f ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, -1);
    Camera camera;
    camera.worldFromCamera = glm::inverse(glm::lookAt(eye, target, up));
    camera.yfovRadians = glm::radians(yfovDegrees);
    return camera;
}

glm::vec3 pixelDirection(const Camera& camera, int x, int y, int width, int height) {
    const float tangent = std::tan(camera.yfovRadians / 2);
    const float ndcX = (float(x) + 0.5f) / float(width) * 2 - 1;
    const float ndcY = 1 - (float(y) + 0.5f) / float(height) * 2;
    const glm::vec3 direction(ndcX * tangent * float(width) / float(height), ndcY * tangent, -1);
    return glm::normalize(glm::mat3(camera.worldFromCamera) * direction);
}

}  // namespace phat::test
