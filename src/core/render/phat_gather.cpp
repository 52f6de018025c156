#include "core/render/phat_gather.h"

#include <memory>
#include <optional>

#include "core/atlas/atlas_position.h"
#include "core/render/lobe_gather.h"
#include "core/render/visible_lobe.h"
#include "core/transport/path_vertex.h"

namespace phat {
namespace {

// Radii in texels: of the first search, and of the neighbours that give the local depth.
constexpr float kFirstRadius = 12.0f;
constexpr float kDepthRadius = 12.0f;
// The neighbourhood itself. Smaller ones than the least are noise alone; the largest holds 13,000 texels.
constexpr float kMinGatherRadius = 4.0f;
constexpr float kLargestRadius = 64.0f;
// Times the harmonic mean distance under the lobe. Measured: .25, .5 and 1 give .158, .153 and .149 on
// tabletop.
constexpr float kRadiusOverDistance = 1.0f;
// Samples that a lobe must have, or the radius grows. The PHATexels' own noise is averaged with them: 2, 8
// and 24 give .160, .152 and .153 on tabletop.
constexpr double kMinGatherSamples = 16.0;
constexpr float kGrowth = 1.4f;  // at least
// Samples beyond which a wider radius would cost time and gain nothing.
constexpr double kPlentyOfSamples = 512.0;
// Tiles that face elsewhere are of another part of the surface.
constexpr float kMinGatherNormalCosine = 0.5f;
// Distances are stored in steps of 5.6 %: a ray to where the light came from must stop short of it.
constexpr float kShortOfEnd = 0.94f;

/// A visible point with what its lobes have in common.
struct Visible {
    const SurfacePoint& point;
    glm::vec3 towardEye;
    AtlasPosition atlasPosition;
    uint64_t& rayCount;
    std::vector<uint32_t> tiles;  // the neighbourhood at its largest
};

class PhatGather {
  public:
    PhatGather(const PhatGatherScene& scene, const PhatGatherSettings& settings)
        : scene_(scene), settings_(settings), tiles_(scene.atlas, scene.points) {
        const std::vector<Frame> frames = blockFrames(scene.atlas, scene.points);
        indirect_ = tilePhatexels(tiles_, scene.phatexture.indirect, scene.phatexture.indirectGuides,
                                  scene.atlas, scene.points, frames);
        area_ = tilePhatexels(tiles_, scene.phatexture.area, scene.phatexture.areaGuides, scene.atlas,
                              scene.points, frames);
    }

    glm::vec3 radianceAlong(const Ray& ray, PixelSample& sample) const;

  private:
    bool showsDirect() const { return phat::showsDirect(settings_.component); }
    bool reconnects() const { return settings_.radiusMeters <= 0.0f; }
    uint32_t surfaceOf(const Visible& visible) const {
        return scene_.atlas.triangleSurface[visible.point.triangle];
    }
    float texelSizeAt(const Visible& visible) const {
        return scene_.atlas.charts[visible.atlasPosition.chart].texelSizeMeters;
    }

    glm::vec3 diffuse(const Visible& visible) const;
    glm::vec3 glossy(Visible& visible) const;
    glm::vec3 lobeRadiance(const Visible& visible, const GatherLobe& lobe, float albedo,
                           const LocalDepth& depth, bool area) const;
    LobeSums sumOver(const Visible& visible, const TiledPhatexels& source, const GatherLobe& lobe,
                     float radius, const LocalDepth& depth) const;
    LocalDepth depthAround(const Visible& visible) const;
    void findTiles(Visible& visible) const;

    template <typename Visit>
    void forNeighbors(const Visible& visible, const TiledPhatexels& source, float radius,
                      const Visit& visit) const {
        const uint32_t surface = surfaceOf(visible);
        for (uint32_t tile : visible.tiles) {
            if (glm::distance(tiles_[tile].center, visible.point.position) > radius + tiles_[tile].radius)
                continue;
            for (const WorldPhatexel& phatexel : source.inTile(tile)) {
                if (phatexel.surface != surface) continue;
                const float cone = 1.0f - glm::distance(phatexel.origin, visible.point.position) / radius;
                if (cone > 0.0f) visit(phatexel, cone);
            }
        }
    }

    PhatGatherScene scene_;
    PhatGatherSettings settings_;
    SurfaceTiles tiles_;
    TiledPhatexels indirect_, area_;
};

void PhatGather::findTiles(Visible& visible) const {
    const float radius = reconnects() ? kLargestRadius * texelSizeAt(visible) : settings_.radiusMeters;
    tiles_.near(visible.point.position, radius, visible.tiles);
    const uint32_t surface = surfaceOf(visible);
    std::erase_if(visible.tiles, [&](uint32_t tile) {
        if (!reconnects()) return tiles_[tile].chart != visible.atlasPosition.chart;
        return surface < tiles_[tile].firstSurface || surface > tiles_[tile].lastSurface ||
               glm::dot(tiles_[tile].normal, visible.point.normalGeometric) < kMinGatherNormalCosine;
    });
}

LocalDepth PhatGather::depthAround(const Visible& visible) const {
    LocalDepth depth(frameFromNormal(visible.point.normalGeometric), scene_.atlas.unitMeters);
    for (const TiledPhatexels* source : {&indirect_, &area_}) {
        forNeighbors(visible, *source, kDepthRadius * texelSizeAt(visible),
                     [&](const WorldPhatexel& phatexel, float cone) {
                         const ReconnectedPhatexel reconnected = reconnect(phatexel, visible.point.position);
                         depth.add(reconnected.direction, reconnected.distance, cone);
                     });
    }
    depth.finish();
    return depth;
}

LobeSums PhatGather::sumOver(const Visible& visible, const TiledPhatexels& source, const GatherLobe& lobe,
                             float radius, const LocalDepth& depth) const {
    LobeSums sums;
    const glm::vec3 origin = scene_.rays.offsetOrigin(visible.point.position, visible.point.normalGeometric);
    forNeighbors(visible, source, radius, [&](const WorldPhatexel& phatexel, float cone) {
        const ReconnectedPhatexel reconnected =
            reconnects() ? reconnect(phatexel, visible.point.position) : unmoved(phatexel);
        float a = lobe.value(reconnected.direction) * reconnected.jacobian * phatexel.inversePdf;
        if (a > 0.0f && reconnects()) {
            if (settings_.traceVisibility) {
                ++visible.rayCount;
                const float distance = kShortOfEnd * reconnected.distance;
                const bool occluded = scene_.rays.hasGlass()
                                          ? bool(seeStraight(scene_.rays, {origin, reconnected.direction},
                                                             distance, visible.rayCount)
                                                     .hit)
                                          : scene_.rays.anyHit(origin, reconnected.direction, distance);
                a *= occluded ? 0.0f : 1.0f;
            } else {
                a *= depth.visibility(reconnected.direction, reconnected.distance);
            }
        }
        sums.add(cone, a, phatexel, reconnected.distance);
    });
    return sums;
}

glm::vec3 PhatGather::lobeRadiance(const Visible& visible, const GatherLobe& lobe, float albedo,
                                   const LocalDepth& depth, bool area) const {
    const TiledPhatexels& source = area ? area_ : indirect_;
    const auto result = [&](const LobeSums& sums) {
        if (sums.a <= 0.0) return glm::vec3(0);
        return area ? sums.regressed(albedo) : sums.mean();
    };
    if (!reconnects()) return result(sumOver(visible, source, lobe, settings_.radiusMeters, depth));
    const float texelSize = texelSizeAt(visible), most = kLargestRadius * texelSize;
    float radius = kFirstRadius * texelSize;
    LobeSums sums = sumOver(visible, source, lobe, radius, depth);
    if (sums.a > 0.0) {
        // Samples grow with the radius squared.
        const float enough = radius * std::sqrt(float(kPlentyOfSamples / sums.effectiveSamples()));
        const float clear = kRadiusOverDistance * sums.distance();
        radius = std::clamp(std::min(clear, enough), kMinGatherRadius * texelSize, most);
        sums = sumOver(visible, source, lobe, radius, depth);
    }
    while (sums.effectiveSamples() < kMinGatherSamples && radius < most) {
        const double missing = kMinGatherSamples / std::max(sums.effectiveSamples(), 1.0);
        radius = std::min(std::max(float(std::sqrt(missing)), kGrowth) * radius, most);
        sums = sumOver(visible, source, lobe, radius, depth);
    }
    return result(sums);
}

glm::vec3 PhatGather::glossy(Visible& visible) const {
    const SurfacePoint& point = visible.point;
    const glm::vec3 eyeLocal = point.shading.toLocal(visible.towardEye);
    const float transmission = clearcoatTransmission(point.brdf, eyeLocal);
    const glm::vec3 albedo =
        transmission * specularAlbedo(point.brdf.f0, point.brdf.f90, point.brdf.alpha, eyeLocal.z);
    if (maxComponent(albedo) <= 0.0f && point.brdf.clearcoat <= 0.0f) return glm::vec3(0);

    findTiles(visible);
    const LocalDepth depth = depthAround(visible);
    const GatherLobe base{point.shading.normal, visible.towardEye, luminance(point.brdf.f0), point.brdf.f90,
                          point.brdf.alpha};
    const float baseAlbedo = specularAlbedo(glm::vec3(base.f0), base.f90, base.alpha, eyeLocal.z).x;
    const GatherLobe coat{point.shading.toWorld(point.brdf.clearcoatNormal), visible.towardEye, kClearcoatF0,
                          1.0f, point.brdf.clearcoatAlpha};
    const float coatAlbedo = (1.0f - transmission) / std::max(point.brdf.clearcoat, 1e-6f);

    glm::vec3 sum(0);
    for (const bool area : {false, true}) {
        if (area ? !showsDirect() : !showsGlossyIndirect(settings_.component)) continue;
        if ((area ? area_ : indirect_).phatexels.empty()) continue;
        if (maxComponent(albedo) > 0.0f) sum += albedo * lobeRadiance(visible, base, baseAlbedo, depth, area);
        if (point.brdf.clearcoat > 0.0f)
            sum += (1.0f - transmission) * lobeRadiance(visible, coat, coatAlbedo, depth, area);
    }
    return sum;
}

glm::vec3 PhatGather::diffuse(const Visible& visible) const {
    const SurfacePoint& point = visible.point;
    const glm::vec3 eyeLocal = point.shading.toLocal(visible.towardEye);
    const glm::vec3 albedo = clearcoatTransmission(point.brdf, eyeLocal) *
                             diffuseWeight(point.brdf, eyeLocal.z) * point.brdf.diffuseColor;
    glm::vec3 irradiance(0);
    const auto add = [&](const std::vector<uint32_t>& map) {
        if (map.empty()) return;
        irradiance += bilinearAt(scene_.atlas, visible.atlasPosition,
                                 [&](size_t texel) { return unpackRgb9e5(map[texel]); });
    };
    if (showsDiffuseIndirect(settings_.component)) add(scene_.phatexture.indirectIrradiance);
    if (showsDirect()) add(scene_.phatexture.areaIrradiance);
    return albedo * irradiance / kPi;
}

glm::vec3 PhatGather::radianceAlong(const Ray& ray, PixelSample& sample) const {
    const SeenThrough seen = visibleThrough(scene_.rays, ray, sample);
    const glm::vec3 direction = seen.ray.direction;
    if (!seen.hit)
        return showsDirect() ? seen.throughput * scene_.lights.environmentRadiance(direction) : glm::vec3(0);
    const SurfacePoint point = surfaceAt(scene_.rays.scene(), seen.hit, direction);
    glm::vec3 radiance(0);
    if (showsDirect())
        radiance += point.emission +
                    punctualLight({scene_.rays, scene_.lights}, point, -direction, sample.rng, sample.rays);
    Visible visible{point, -direction, atlasPositionOf(scene_.atlas, seen.hit), sample.rays, {}};
    if (visible.atlasPosition.chart != kNoChart && reflects(point.brdf))
        radiance += diffuse(visible) + glossy(visible);
    return seen.throughput * radiance;
}

}  // namespace

Integrator phatGather(const PhatGatherScene& scene, const PhatGatherSettings& settings) {
    const auto gather = std::make_shared<const PhatGather>(scene, settings);
    return [gather](const Ray& ray, PixelSample& sample) { return gather->radianceAlong(ray, sample); };
}

}  // namespace phat
