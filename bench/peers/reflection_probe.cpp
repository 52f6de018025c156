#include "reflection_probe.h"

#include "core/base/parallel.h"
#include "core/phatexel/phatexture.h"

namespace phat::peers {
namespace {

constexpr int kFaces = 6;
constexpr int kBytesPerTexel = 4;
constexpr uint64_t kPurpose = 0x70726f6265;  // "probe", apart from the bake's streams

// Lookups for one prefiltered value. Not tuned: an engine takes them once, beforehand, so many cost nothing.
constexpr int kPrefilterSamples = 1024;

// Faces are +x, -x, +y, -y, +z, -z; u and v in [-1, 1] run along the next two axes.
glm::vec3 cubeDirection(int face, glm::vec2 uv) {
    glm::vec3 d(0);
    const int axis = face / 2;
    d[axis] = face % 2 == 0 ? 1.0f : -1.0f;
    d[(axis + 1) % 3] = uv.x;
    d[(axis + 2) % 3] = uv.y;
    return glm::normalize(d);
}

struct CubePosition {
    int face;
    glm::vec2 uv;
};

CubePosition cubePosition(glm::vec3 d) {
    const glm::vec3 size = glm::abs(d);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    return {2 * axis + (d[axis] < 0.0f ? 1 : 0),
            glm::vec2(d[(axis + 1) % 3], d[(axis + 2) % 3]) / size[axis]};
}

// GGX around the mirrored direction as if it were normal and eye.
glm::vec3 prefiltered(const ReflectionProbe& probe, glm::vec3 mirrored, float alpha) {
    const Frame frame = frameFromNormal(mirrored);
    // Golden-ratio (R2) points (Roberts 2018).
    constexpr glm::vec2 kR2(0.7548776662f, 0.5698402910f);
    glm::vec3 sum(0);
    float weights = 0;
    for (int i = 0; i < kPrefilterSamples; ++i) {
        const glm::vec3 half =
            squareToVisibleNormal(glm::fract(0.5f + float(i) * kR2), glm::vec3(0, 0, 1), alpha);
        const glm::vec3 light = 2.0f * half.z * half - glm::vec3(0, 0, 1);
        if (light.z <= 0.0f) continue;
        sum += light.z * probeRadiance(probe, glm::normalize(frame.toWorld(light)));
        weights += light.z;
    }
    return weights > 0.0f ? sum / weights : glm::vec3(0);
}

}  // namespace

uint64_t probeBytes(int faceSize) {
    return uint64_t(kFaces) * uint64_t(faceSize) * uint64_t(faceSize) * kBytesPerTexel * 4 / 3;
}

int probeFaceSize(uint64_t bytes) {
    const auto size = int(std::sqrt(double(bytes) / double(kFaces * kBytesPerTexel * 4 / 3)));
    return std::max(size, 1);
}

ReflectionProbe bakeProbe(const RayScene& rays, const LightSampler& lights, const ProbeSettings& settings,
                          Progress& progress) {
    ReflectionProbe probe{settings.position, settings.box, settings.faceSize, {}};
    const size_t faceTexels = size_t(settings.faceSize) * size_t(settings.faceSize);
    probe.radiance.resize(kFaces * faceTexels);
    const ProgressStage stage(progress, "probe", probe.radiance.size());
    parallelRanges(probe.radiance.size(), 64, progress, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            Rng rng(hashOf(settings.seed, kPurpose, i));
            const size_t inFace = i % faceTexels;
            const glm::vec2 texel(inFace % size_t(settings.faceSize), inFace / size_t(settings.faceSize));
            // Every path has its own ray: the texel is filtered.
            PathSettings paths = settings.paths;
            paths.pathsPerHit = 1;
            glm::vec3 sum(0);
            for (int path = 0; path < settings.paths.pathsPerHit; ++path) {
                const glm::vec2 uv = (texel + rng.uniform2()) / float(settings.faceSize) * 2.0f - 1.0f;
                sum +=
                    traceIncident({rays, lights}, {settings.position, cubeDirection(int(i / faceTexels), uv)},
                                  paths, Rng(hashOf(settings.seed, i, uint64_t(path))))
                        .reflected;
            }
            probe.radiance[i] = unpackRgb9e5(packRgb9e5(sum / float(settings.paths.pathsPerHit)));
        }
    });
    return probe;
}

glm::vec3 probeRadiance(const ReflectionProbe& probe, glm::vec3 direction) {
    const CubePosition position = cubePosition(direction);
    const auto last = float(probe.faceSize - 1);
    const glm::vec2 texel =
        glm::clamp((0.5f * position.uv + 0.5f) * float(probe.faceSize) - 0.5f, 0.0f, last);
    const glm::ivec2 low(texel);
    const glm::ivec2 high = glm::min(low + 1, probe.faceSize - 1);
    const glm::vec2 t = texel - glm::vec2(low);
    const auto at = [&](int x, int y) {
        return probe
            .radiance[(size_t(position.face) * size_t(probe.faceSize) + size_t(y)) * size_t(probe.faceSize) +
                      size_t(x)];
    };
    return glm::mix(glm::mix(at(low.x, low.y), at(high.x, low.y), t.x),
                    glm::mix(at(low.x, high.y), at(high.x, high.y), t.x), t.y);
}

glm::vec3 boxProjected(const ReflectionProbe& probe, glm::vec3 position, glm::vec3 direction) {
    // To the far side of each slab; the nearest of the three is where the ray leaves the box.
    float distance = kFarDistance;
    for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0.0f) continue;
        const float side = direction[axis] > 0.0f ? probe.box.high[axis] : probe.box.low[axis];
        distance = std::min(distance, std::max((side - position[axis]) / direction[axis], 0.0f));
    }
    return glm::normalize(position + distance * direction - probe.position);
}

glm::vec3 shadeByProbe(const ReflectionProbe& probe, const SurfacePoint& point, glm::vec3 towardEye) {
    const glm::vec3 normal = point.shading.normal;
    const float nDotV = glm::dot(normal, towardEye);
    if (nDotV <= 0.0f) return glm::vec3(0);
    const glm::vec3 mirrored = glm::normalize(2.0f * nDotV * normal - towardEye);
    return specularAlbedo(point.brdf.f0, point.brdf.f90, point.brdf.alpha, nDotV) *
           prefiltered(probe, boxProjected(probe, point.position, mirrored), point.brdf.alpha);
}

}  // namespace phat::peers
