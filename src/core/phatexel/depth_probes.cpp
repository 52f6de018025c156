#include "core/phatexel/depth_probes.h"

#include "core/base/hemisphere_map.h"
#include "core/base/parallel.h"
#include "core/phatexel/phatexture.h"

namespace phat {
namespace {

// In units of length: Atlas::unitMeters.
float unitsOf(uint32_t code) {
    return unpackDistance(code, 1);
}
float levelZero(const DepthProbe& probe) {
    return unitsOf(std::max(4 * probe.low, 1u));
}
float topLevel(const DepthProbe& probe) {
    return unitsOf(std::min(4 * probe.high, 254u));
}

DepthProbe roundToLevels(const std::array<uint8_t, kProbeSize * kProbeSize>& codes) {
    const uint8_t far = uint8_t(packDistance(kFarDistance, 1));
    DepthProbe probe;
    probe.low = far;
    for (uint8_t code : codes)
        if (code != far) {
            probe.low = std::min<uint32_t>(probe.low, code / 4);
            probe.high = std::max<uint32_t>(probe.high, (code + 3) / 4);
        }
    probe.low = std::min(probe.low, probe.high);
    const float low = std::log2(levelZero(probe)),
                octaves = std::max(std::log2(topLevel(probe)) - low, 1e-6f);
    for (size_t i = 0; i < codes.size(); ++i) {
        const float fraction = (std::log2(unitsOf(codes[i])) - low) / octaves;
        probe.level[i] = codes[i] == far
                             ? uint8_t(kFarLevel)
                             : uint8_t(std::lround(std::clamp(fraction, 0.0f, 1.0f) * (kFarLevel - 1)));
    }
    return probe;
}

}  // namespace

float probeDistance(const DepthProbe& probe, uint32_t level, float unitMeters) {
    if (level == kFarLevel) return kFarDistance;
    const float low = levelZero(probe);
    return unitMeters * low * std::pow(topLevel(probe) / low, float(level) / float(kFarLevel - 1));
}

DepthProbe traceDepthProbe(const Atlas& atlas, const TexelPoints& points, const std::vector<Frame>& frames,
                           const TilePatch& patch, size_t tile, const RayScene& rays) {
    if (patch.empty) {
        DepthProbe nothing;
        nothing.level.fill(uint8_t(kFarLevel));
        return nothing;
    }
    // One ray a cell, through its middle: the least of several makes floors near pedestals too dark, because
    // near hits are looked up in a small neighbourhood.
    static const auto kDirections = [] {
        std::array<glm::vec3, kProbeSize * kProbeSize> directions;
        for (int i = 0; i < kProbeSize * kProbeSize; ++i)
            directions[size_t(i)] =
                squareToHemisphere((glm::vec2(i % kProbeSize, i / kProbeSize) + 0.5f) / float(kProbeSize));
        return directions;
    }();
    const glm::uvec2 texel = glm::uvec2(tile % atlas.sizeTiles().x, tile / atlas.sizeTiles().x) * kTileSize +
                             glm::uvec2(patch.probeTexel % kTileSize, patch.probeTexel / kTileSize);
    const size_t index = size_t(texel.y) * atlas.sizeTexels.x + texel.x;
    const Frame& frame = frames[atlas.blockAt(texel)];
    const glm::vec3 normal = points.normal[index];
    const glm::vec3 from = rays.offsetOrigin(points.position[index], normal);
    std::array<uint8_t, kProbeSize * kProbeSize> codes;
    for (size_t cell = 0; cell < kDirections.size(); ++cell) {
        // No lobe looks below the texel's own horizon: such rays go along it.
        const glm::vec3 w = frame.toWorld(kDirections[cell]);
        const glm::vec3 above = w - std::min(glm::dot(w, normal) - 0.01f, 0.0f) * normal;
        const Hit hit = rays.closestHit(from, glm::normalize(above));
        codes[cell] = uint8_t(packDistance(hit ? hit.distance : kFarDistance, atlas.unitMeters));
    }
    return roundToLevels(codes);
}

std::vector<DepthProbe> traceDepthProbes(const Atlas& atlas, const TexelPoints& points,
                                         const std::vector<Frame>& frames,
                                         const std::vector<TilePatch>& patches, const RayScene& rays,
                                         Progress& progress) {
    std::vector<DepthProbe> probes(patches.size());
    parallelRanges(probes.size(), 64, progress, [&](size_t begin, size_t end) {
        for (size_t tile = begin; tile < end; ++tile)
            probes[tile] = traceDepthProbe(atlas, points, frames, patches[tile], tile, rays);
    });
    return probes;
}

}  // namespace phat
