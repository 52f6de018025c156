#include "core/render/punctual_irradiance.h"

#include "core/atlas/chart_fill.h"
#include "core/atlas/dilate.h"
#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/base/sobol.h"
#include "core/transport/path_vertex.h"

namespace phat {
namespace {

// Where the points of the texels are whose centres are `offset` texels aside.
TexelPoints pointsAside(const Scene& scene, const Atlas& atlas, glm::vec2 offset) {
    Atlas moved = atlas;
    for (auto& corners : moved.triangleTexels)
        for (glm::vec2& corner : corners) corner -= offset;
    return buildTexelPoints(scene, moved);
}

struct Receiver {
    glm::vec3 position, normal, flatNormal;  // normals on the lit side
};

// Calls visit(direction, irradiance of a plane that faces it) for the light that arrives. `onDisc`: the point
// on lights that are discs.
template <class Visit>
void forEachLight(const LitScene& scene, const Receiver& at, glm::vec2 onDisc, const Visit& visit) {
    const glm::vec3 origin = scene.rays.offsetOrigin(at.position, at.flatNormal);
    uint64_t rayCount = 0;
    for (size_t i = 0; i < scene.rays.scene().lights.size(); ++i) {
        const LightSample light = scene.lights.samplePunctual(i, at.position, onDisc);
        if (!(light.pdf > 0) || glm::dot(at.normal, light.towardLight) <= 0 ||
            glm::dot(at.flatNormal, light.towardLight) <= 0)
            continue;
        visit(light.towardLight,
              light.radiance * transmittanceToLight(scene.rays, at.position, origin, light, rayCount));
    }
}

}  // namespace

std::vector<glm::vec3> punctualIrradiance(const LitScene& scene, const Atlas& atlas,
                                          const TexelPoints& points, Progress& progress,
                                          IrradianceTerms* terms) {
    constexpr uint64_t kSeed = 0x70756e6374;
    const size_t count = atlas.texelCount();
    std::vector<glm::vec3> sum(count, glm::vec3(0));
    std::vector<uint8_t> found(count, 0);  // points on the surface
    const ProgressStage stage(progress, "lights", count * kPunctualPoints);
    for (uint32_t sample = 0; sample < kPunctualPoints; ++sample) {
        const glm::uvec2 cell(sample % kPunctualPointsPerSide, sample / kPunctualPointsPerSide);
        const glm::vec2 offset = (glm::vec2(cell) + 0.5f) / float(kPunctualPointsPerSide) - 0.5f;
        const TexelPoints aside = pointsAside(scene.rays.scene(), atlas, offset);
        parallelRanges(count, 4096, progress, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                if (aside.state[i] != TexelState::surface || points.state[i] == TexelState::occluded)
                    continue;
                const Receiver at{aside.position[i], aside.normal[i],
                                  flatNormalOf(scene.rays.scene(), atlas, aside, i)};
                const glm::vec2 onDisc(sobol4(sample, uint32_t(hashOf(kSeed, i))));
                forEachLight(scene, at, onDisc, [&](glm::vec3 direction, glm::vec3 arriving) {
                    sum[i] += glm::dot(at.normal, direction) * arriving;
                    if (terms) terms->addLight(i, direction, arriving);
                });
                ++found[i];
            }
        });
    }
    for (size_t i = 0; i < count; ++i)
        if (found[i] > 0) sum[i] /= float(found[i]);
    if (terms)
        for (std::vector<glm::vec3>& term : terms->term) dilateWithinCharts(term, found, atlas);
    fillWithinCharts(sum, found, atlas, points);
    return sum;
}

}  // namespace phat
