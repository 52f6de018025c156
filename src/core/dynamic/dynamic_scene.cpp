#include "core/dynamic/dynamic_scene.h"

#include <algorithm>

#include "core/bake/irradiance.h"
#include "core/base/parallel.h"
#include "core/scene/scene_motion.h"

namespace phat {
namespace {

// Greatest number of separate boxes: the positions of a node that moves in every frame.
constexpr size_t kMaxChanges = 48;

Frame movedFrame(const Frame& frame, const glm::mat4& m) {
    return frameFromNormalAndTangent(glm::normalize(normalMatrix(m) * frame.normal),
                                     glm::mat3(m) * frame.tangent);
}

Bounds boundsOfSurface(const Scene& scene, const Surface& surface) {
    Bounds bounds;
    for (uint32_t t = 0; t < surface.triangleCount; ++t)
        for (int corner = 0; corner < 3; ++corner)
            bounds.add(scene.positions[scene.triangles[surface.firstTriangle + t][corner]]);
    return bounds;
}

}  // namespace

DynamicScene::DynamicScene(SharedSnapshot rest, const Atlas& atlas, const TexelPoints& points)
    : atlas_(atlas),
      now_(std::move(rest)),
      points_(points),
      frames_(blockFrames(atlas, points)),
      restPoints_(points),
      restState_(buildTexelPoints(now_->scene(), atlas).state),
      restFrames_(frames_),
      committedState_(points.state),
      irradianceTexels_(phat::irradianceTexels(atlas, points)),
      surfaceTexels_(atlas.charts.size(), 0),
      chartMoved_(atlas.charts.size(), 0) {
    patches_ = restPatches_ = fitTilePatches(atlas_, points_, frames_);
    restPoints_.state = {};
    restPoints_.triangle = {};
    restPoints_.barycentric = {};
    for (size_t i = 0; i < points_.state.size(); ++i)
        if (points_.state[i] == TexelState::surface) ++surfaceTexels_[atlas_.chartAt(i)];
}

void DynamicScene::addChange(const Bounds& box, SceneChange::Kind kind) {
    if (box.empty()) return;
    // A light that changes in every frame needs one box, not one for each frame.
    if (kind != SceneChange::Kind::surface)
        std::erase_if(changes_, [&](const SceneChange& change) {
            return change.kind == kind && change.box.low == box.low && change.box.high == box.high;
        });
    if (changes_.size() >= kMaxChanges) {
        // The older half in one box, as if all of it were as recent as its last.
        const size_t half = kMaxChanges / 2;
        SceneChange& kept = changes_[half - 1];
        for (size_t i = 0; i + 1 < half; ++i) {
            kept.box.add(changes_[i].box.low);
            kept.box.add(changes_[i].box.high);
            kept.kind = std::min(kept.kind, changes_[i].kind);
        }
        changes_.erase(changes_.begin(), changes_.begin() + ptrdiff_t(half) - 1);
    }
    changes_.push_back({version_, box, kind});
}

void DynamicScene::moveChart(const Chart& chart, const glm::mat4& m) {
    const glm::mat3 normals = normalMatrix(m), linear(m);
    const bool atRest = m == glm::mat4(1);  // exactly as it was
    const glm::uvec2 origin = chart.originTexel(), size = chart.sizeTexels();
    const auto tileOf = [&](uint32_t x, uint32_t y) {
        return size_t(chart.originTile.y + y) * atlas_.sizeTiles().x + chart.originTile.x + x;
    };
    SilentProgress silent;
    parallelRanges(size.y, 8, silent, [&](size_t begin, size_t end) {
        for (size_t y = begin; y < end; ++y)
            for (uint32_t x = 0; x < size.x; ++x) {
                const size_t i = (origin.y + y) * atlas_.sizeTexels.x + origin.x + x;
                if (points_.triangle[i] == kNoTriangle) continue;
                points_.position[i] = movedPoint(m, restPoints_.position[i]);
                const glm::vec3 normal = glm::normalize(normals * restPoints_.normal[i]);
                const Frame frame = frameFromNormalAndTangent(normal, linear * restPoints_.tangent[i]);
                points_.normal[i] = atRest ? restPoints_.normal[i] : normal;
                points_.tangent[i] = atRest ? restPoints_.tangent[i] : frame.tangent;
            }
    });
    for (uint32_t b = 0; b < chart.blocksWide() * chart.blocksHigh(); ++b)
        frames_[chart.firstBlock + b] =
            atRest ? restFrames_[chart.firstBlock + b] : movedFrame(restFrames_[chart.firstBlock + b], m);
    for (uint32_t y = 0; y < chart.sizeTiles.y; ++y)
        for (uint32_t x = 0; x < chart.sizeTiles.x; ++x) {
            TilePatch& patch = patches_[tileOf(x, y)];
            const TilePatch& rest = restPatches_[tileOf(x, y)];
            patch.center = movedPoint(m, rest.center);
            patch.alongX = linear * rest.alongX;
            patch.alongY = linear * rest.alongY;
        }
}

bool DynamicScene::moveNodes(const SceneSnapshot& next) {
    bool any = false;
    const std::vector<Surface>& surfaces = next.scene().surfaces;
    std::vector<uint8_t> surfaceMoves(surfaces.size(), 0);
    for (size_t s = 0; s < surfaces.size(); ++s) {
        const uint32_t node = surfaces[s].node;
        if (matrixAt(next.worldFromRest(), node) == matrixAt(now_->worldFromRest(), node)) continue;
        any = true;
        surfaceMoves[s] = 1;
        addChange(boundsOfSurface(scene(), surfaces[s]), SceneChange::Kind::surface);
        addChange(boundsOfSurface(next.scene(), surfaces[s]), SceneChange::Kind::surface);
    }
    for (size_t c = 0; c < atlas_.charts.size(); ++c) {
        const Chart& chart = atlas_.charts[c];
        if (!surfaceMoves[chart.surface]) continue;
        moveChart(chart, matrixAt(next.worldFromRest(), surfaces[chart.surface].node));
        chartMoved_[c] = version_;
    }
    return any;
}

void DynamicScene::addReachOf(const PunctualLight& light, const Scene& scene) {
    if (light.type == PunctualLight::Type::directional || light.rangeMeters <= 0)
        addChange(boundsOf(scene), SceneChange::Kind::wholeScene);
    else
        addChange({light.position - light.rangeMeters, light.position + light.rangeMeters},
                  SceneChange::Kind::lightRange);
}

bool DynamicScene::noteLights(const Scene& next) {
    const std::vector<PunctualLight>&lights = scene().lights, &nextLights = next.lights;
    if (nextLights == lights) return false;
    for (size_t i = 0; i < std::max(nextLights.size(), lights.size()); ++i) {
        const PunctualLight* before = i < lights.size() ? &lights[i] : nullptr;
        const PunctualLight* now = i < nextLights.size() ? &nextLights[i] : nullptr;
        if (before && now && *before == *now) continue;
        if (before) addReachOf(*before, next);
        if (now) addReachOf(*now, next);
    }
    return true;
}

bool DynamicScene::noteMaterials(const Scene& next) {
    if (next.materials == scene().materials) return false;
    for (const Surface& surface : next.surfaces)
        if (!(next.materials[surface.material] == scene().materials[surface.material]))
            addChange(boundsOfSurface(next, surface), SceneChange::Kind::surface);
    return true;
}

ChangedParts DynamicScene::set(SharedSnapshot next) {
    ++version_;
    ChangedParts changed;
    changed.nodes = moveNodes(*next);
    changed.lights = noteLights(next->scene());
    changed.materials = noteMaterials(next->scene());
    if (changed)
        now_ = std::move(next);
    else
        --version_;
    return changed;
}

void DynamicScene::markOccluded(size_t tile, const RayScene& rays) {
    const glm::uvec2 corner =
        glm::uvec2(tile % atlas_.sizeTiles().x, tile / atlas_.sizeTiles().x) * kTileSize;
    for (uint32_t i = 0; i < kTileSize * kTileSize; ++i) {
        const size_t texel =
            size_t(corner.y + i / kTileSize) * atlas_.sizeTexels.x + corner.x + i % kTileSize;
        if (restState_[texel] == TexelState::unused) continue;
        points_.state[texel] = restState_[texel];
        if (isOccludedTexel(points_, atlas_, rays, texel)) points_.state[texel] = TexelState::occluded;
    }
}

bool DynamicScene::commitOccluded(size_t tile) {
    const glm::uvec2 corner =
        glm::uvec2(tile % atlas_.sizeTiles().x, tile / atlas_.sizeTiles().x) * kTileSize;
    const uint32_t chart = atlas_.tileChart[tile];
    const uint32_t surfaceBefore = surfaceTexels_[chart];
    bool any = false;
    for (uint32_t i = 0; i < kTileSize * kTileSize; ++i) {
        const size_t texel =
            size_t(corner.y + i / kTileSize) * atlas_.sizeTexels.x + corner.x + i % kTileSize;
        const TexelState before = committedState_[texel], now = points_.state[texel];
        if (before == now) continue;
        any = true;
        surfaceTexels_[chart] -= before == TexelState::surface;
        surfaceTexels_[chart] += now == TexelState::surface;
        committedState_[texel] = now;
        irradianceTexels_[texel] =
            now == TexelState::surface || (now == TexelState::gutter && surfaceTexels_[chart] == 0);
    }
    if (!any) return false;
    ++texelsVersion_;
    // Gutters stand in where no texel of a chart is on its surface.
    if ((surfaceBefore == 0) != (surfaceTexels_[chart] == 0)) {
        const glm::uvec2 origin = atlas_.charts[chart].originTexel(),
                         size = atlas_.charts[chart].sizeTexels();
        for (uint32_t y = 0; y < size.y; ++y)
            for (uint32_t x = 0; x < size.x; ++x) {
                const size_t texel = size_t(origin.y + y) * atlas_.sizeTexels.x + origin.x + x;
                irradianceTexels_[texel] =
                    points_.state[texel] == TexelState::surface ||
                    (points_.state[texel] == TexelState::gutter && surfaceTexels_[chart] == 0);
            }
    }
    TilePatch& rest = restPatches_[tile];
    const TilePatch fitted = fitTilePatch(atlas_, points_, frames_, tile);
    rest.probeTexel = patches_[tile].probeTexel = fitted.probeTexel;
    rest.empty = patches_[tile].empty = fitted.empty;
    rest.groupBits = patches_[tile].groupBits = fitted.groupBits;
    return true;
}

}  // namespace phat
