// How a fixed number of texels is best spread. A reflection is averaged over the neighbourhood that holds
// enough PHATexels under its lobe. The lobe's solid angle grows with alpha^2, so the neighbourhood's radius
// is about h / alpha for texels of side h; what it blurs has details of about alpha times the distance. The
// error is
//     F h / alpha^2          F: reflectance, alpha: roughness squared
// With areas A, the sum of A F h / alpha^2 under a fixed sum of A / h^2 is least where (Lagrange)
//     1 / h is proportional to (F / alpha^2)^(1/3)
// That the error is linear in h is a heuristic; measured on tabletop's metal table it is less steep.

#include "core/atlas/glossy_density.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/scene/shading.h"

namespace phat {
namespace {

// A perfect metal of this roughness is as well off as a rough surface: reflections that wide show no texels
// (at .6 halving the texels changes the error from .029 to .027, at .15 from .069 to .031).
constexpr float kRoughEnough = 0.6f;
// Sharper lobes find so few PHATexels that relighting widens them, whatever the texels' size.
constexpr float kSharpest = 0.2f;
constexpr float kMaxCoarsening = 1.25f;
// Textured materials are evaluated at so many points: the cube root damps the noise of their mean.
constexpr uint32_t kSamplePoints = 64;

// F / alpha^2 of one lobe, 1 for the perfect metal above.
float weightOfLobe(float reflectance, float alpha) {
    return reflectance * square(square(kRoughEnough) / std::max(alpha, square(kSharpest)));
}

float weightOf(const Brdf& brdf) {
    return weightOfLobe(luminance(brdf.f0), brdf.alpha) +
           weightOfLobe(brdf.clearcoat * kClearcoatF0, brdf.clearcoatAlpha);
}

// Whether the weight is at most 1 at every point of the surface.
bool roughEverywhere(const Material& m) {
    return m.unlit ||
           (m.metallicRoughnessTexture.image < 0 && m.roughness >= kRoughEnough && m.clearcoat <= 0);
}

double areaOf(const Scene& scene, uint32_t triangle) {
    const glm::uvec3& t = scene.triangles[triangle];
    return 0.5 * double(glm::length(glm::cross(scene.positions[t.y] - scene.positions[t.x],
                                               scene.positions[t.z] - scene.positions[t.x])));
}

// Mean weight over points that are stratified by area.
double meanWeight(const Scene& scene, const Surface& surface) {
    double area = 0;
    for (uint32_t t = 0; t < surface.triangleCount; ++t) area += areaOf(scene, surface.firstTriangle + t);
    if (!(area > 0)) return 0;
    double sum = 0, passed = 0;
    uint32_t sample = 0;
    for (uint32_t t = surface.firstTriangle; t < surface.firstTriangle + surface.triangleCount; ++t) {
        passed += areaOf(scene, t);
        for (; sample < kSamplePoints && (sample + 0.5) * area <= passed * kSamplePoints; ++sample) {
            Rng random(hashOf(surface.firstTriangle, sample));
            glm::vec2 b = random.uniform2();
            if (b.x + b.y > 1) b = 1.0f - b;
            sum += double(weightOf(surfaceAt(scene, t, b, false).brdf));
        }
    }
    return sample > 0 ? sum / sample : 0;
}

}  // namespace

std::vector<float> glossyDensities(const Scene& scene, float maxDensity) {
    std::vector<float> densities(scene.surfaces.size(), 1.0f);
    if (!(maxDensity > 1)) return densities;
    tbb::parallel_for(size_t(0), scene.surfaces.size(), [&](size_t i) {
        const Surface& surface = scene.surfaces[i];
        if (roughEverywhere(scene.materials[surface.material])) return;
        densities[i] = std::clamp(float(std::cbrt(meanWeight(scene, surface))), 1.0f, maxDensity);
    });
    return densities;
}

void keepBudget(std::span<const double> area, std::span<double> density) {
    if (density.empty()) return;
    const double least = *std::min_element(density.begin(), density.end());
    for (double& d : density) d /= least;
    // Of the pieces' excess g = density - 1: sum A (1 + s g)^2 <= kMaxCoarsening^2 sum A, for the largest s.
    double total = 0, linear = 0, quadratic = 0;
    for (size_t i = 0; i < area.size(); ++i) {
        const double excess = density[i] - 1;
        total += area[i];
        linear += area[i] * excess;
        quadratic += area[i] * excess * excess;
    }
    const double room = (double(square(kMaxCoarsening)) - 1) * total;
    if (2 * linear + quadratic <= room) return;
    const double scale = (std::sqrt(linear * linear + quadratic * room) - linear) / quadratic;
    for (double& d : density) d = 1 + scale * (d - 1);
}

}  // namespace phat
