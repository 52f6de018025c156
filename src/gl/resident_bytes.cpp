#include "gl/resident_bytes.h"

#include "gl/textures.h"

namespace phat {
namespace {

template <class... Textures>
uint64_t bytesOf(const Textures&... textures) {
    return (uint64_t(0) + ... + textureBytes(textures));
}

uint64_t sceneBytes(const GpuScene& scene) {
    GLint64 vertices = 0;
    glGetNamedBufferParameteri64v(scene.vertices.name(), GL_BUFFER_SIZE, &vertices);
    uint64_t sum = uint64_t(vertices) +
                   bytesOf(scene.white, scene.splitSum, scene.environment.picture, scene.environment.choices);
    for (const auto* images : {&scene.imagesLinear, &scene.imagesSrgb})
        for (const GlTexture& image : *images) sum += textureBytes(image);
    return sum;
}

}  // namespace

uint64_t addedBytes(const GpuAdded& added) {
    return sceneBytes(added.scene) + bytesOf(added.probes.cells, added.probes.light, added.probes.distances);
}

ResidentBytes residentBytesOf(const GpuScene& scene, const GpuAtlas& atlas, const GpuLookup& lookup,
                              const ShadowMaps& shadows, const FrameTargets& targets) {
    ResidentBytes bytes;
    bytes.scene = sceneBytes(scene);
    bytes.phatexels = textureBytes(atlas.phatexels);
    for (const GpuPhatexels& source : atlas.sources) {
        bytes.phatexels += textureBytes(source.texelPdf);
        bytes.pyramid += textureBytes(source.guidePdf);
    }
    bytes.lookup = bytesOf(lookup.inverseCdfs, lookup.probes, lookup.scrambles, atlas.tilePatches,
                           atlas.charts, atlas.tileTable, atlas.tileLight);
    bytes.irradiance = textureBytes(atlas.irradiance);
    bytes.shadows = bytesOf(shadows.depth, shadows.tints, shadows.lightTable);
    const ReflectionTargets& traced = targets.reflections;
    const LookupTargets& looked = targets.lookup;
    bytes.frame = bytesOf(targets.picture, targets.depth, looked.incident, looked.pooled, looked.reflectances,
                          looked.baseLobes, looked.coatLobes, traced.base, traced.coat, traced.surface);
    const RayTargets& rays = targets.rays;
    bytes.frame += bytesOf(rays.points, rays.hits, rays.places, rays.indirectSums, rays.areaSums, rays.means,
                           rays.pooled, rays.counts);
    for (const auto& frame : rays.frames)
        for (const RayTargets::Frame& lobe : frame) bytes.frame += bytesOf(lobe.guides, lobe.light);
    const GlassTargets& glass = targets.glass;
    bytes.frame += bytesOf(glass.depth, glass.panes.base, glass.panes.coat, glass.panes.surface,
                           glass.paneLight, glass.behind);
    return bytes;
}

uint64_t rayBytes(const GpuRayScene& rays) {
    return bytesOf(rays.bvh.nodes, rays.bvh.triangles, rays.bvh.opacity, rays.bvh.alphas, rays.hits.table,
                   rays.hits.images.colors, rays.hits.images.linear);
}

uint64_t pyramidBytes(const RelightPass& pass) {
    return bytesOf(pass.texelBrdf, pass.lobes, pass.statistics, pass.radii);
}

uint64_t surfaceBytes(const GpuTexelSurfaces& surfaces) {
    return bytesOf(surfaces.normals, surfaces.materialIndex, surfaces.texturesA, surfaces.texturesB);
}

}  // namespace phat
