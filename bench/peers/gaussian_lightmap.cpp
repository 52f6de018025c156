#include "gaussian_lightmap.h"

#include <optional>

#include "core/base/hemisphere_map.h"
#include "core/base/parallel.h"
#include "core/phatexel/phatexture.h"
#include "peer_picture.h"

namespace phat::peers {
namespace {

constexpr uint64_t kPurpose = 0x6761757373;  // "gauss", apart from the bake's streams

// Where the two nearest gaussians cross, both have fallen to this. ours, not tuned.
constexpr float kCrossing = 0.65f;

// Golden-ratio (R2) points (Roberts 2018).
glm::vec2 r2Point(int i, glm::vec2 shift) {
    return glm::fract(shift + float(i) * glm::vec2(0.7548776662f, 0.5698402910f));
}

float gaussianAt(const GaussianBasis& basis, int i, glm::vec3 direction) {
    return std::exp(basis.sharpness * (glm::dot(basis.axis[size_t(i)], direction) - 1.0f));
}

std::optional<size_t> litTexel(const GaussianLightmap& lightmap, glm::ivec2 texel, uint32_t chart) {
    const glm::ivec2 size(lightmap.atlas.sizeTexels);
    if (texel.x < 0 || texel.y < 0 || texel.x >= size.x || texel.y >= size.y) return {};
    if (lightmap.atlas.chartAt(texel) != chart) return {};
    const size_t index = size_t(texel.y) * size_t(size.x) + size_t(texel.x);
    if (!lightmap.points.valid(index)) return {};
    return index;
}

struct Read {
    Amplitudes amplitudes{};
    Frame frame;
    bool found = false;
};

// Bilinear over the chart's texels that have light.
Read readTexels(const GaussianLightmap& lightmap, const Hit& hit) {
    Read read;
    const uint32_t chart = lightmap.atlas.triangleChart[hit.triangle];
    if (chart == kNoChart) return read;
    const auto& corner = lightmap.atlas.triangleTexels[hit.triangle];
    const glm::vec2 position = corner[0] + hit.barycentric.x * (corner[1] - corner[0]) +
                               hit.barycentric.y * (corner[2] - corner[0]) - 0.5f;
    const glm::ivec2 low(glm::floor(position));
    const glm::vec2 t = position - glm::vec2(low);
    float weights = 0, largest = 0;
    for (int i = 0; i < 4; ++i) {
        const glm::ivec2 side(i & 1, i >> 1);
        const std::optional<size_t> texel = litTexel(lightmap, low + side, chart);
        const float weight = (side.x == 1 ? t.x : 1 - t.x) * (side.y == 1 ? t.y : 1 - t.y);
        if (!texel || weight <= 0.0f) continue;
        for (int g = 0; g < kGaussians; ++g)
            read.amplitudes[size_t(g)] += weight * lightmap.texels[*texel][size_t(g)];
        if (weight > largest)
            read.frame =
                frameFromNormalAndTangent(lightmap.points.normal[*texel], lightmap.points.tangent[*texel]);
        largest = std::max(largest, weight);
        weights += weight;
    }
    read.found = weights > 0.0f;
    if (read.found)
        for (glm::vec3& amplitude : read.amplitudes) amplitude /= weights;
    return read;
}

// Integral over the sphere of the product of two gaussians of amplitude 1.
float productIntegral(glm::vec3 axisA, float sharpnessA, glm::vec3 axisB, float sharpnessB) {
    const float length = glm::length(sharpnessA * axisA + sharpnessB * axisB);
    return 2.0f * kPi * std::exp(length - sharpnessA - sharpnessB) * (1.0f - std::exp(-2.0f * length)) /
           length;
}

// Wang et al. 2009, "All-Frequency Rendering of Dynamic, Spatially-Varying Reflectance": D as a gaussian of
// normals, then of directions; masking, Fresnel and cosine are taken at its middle.
glm::vec3 warpedReading(const GaussianBasis& basis, const Amplitudes& amplitudes, const Brdf& brdf,
                        glm::vec3 eye) {
    const glm::vec3 normal(0, 0, 1);
    const glm::vec3 axis = 2.0f * eye.z * normal - eye;
    const float alpha2 = square(brdf.alpha);
    const float sharpness = 2.0f / alpha2 / (4.0f * std::max(eye.z, 1e-4f));
    glm::vec3 light(0);
    for (int i = 0; i < kGaussians; ++i)
        light +=
            amplitudes[size_t(i)] * productIntegral(axis, sharpness, basis.axis[size_t(i)], basis.sharpness);
    const glm::vec3 fresnel = schlick(brdf.f0, brdf.f90, glm::dot(eye, glm::normalize(axis + eye)));
    return light / (kPi * alpha2) * smithV(axis.z, eye.z, brdf.alpha) * fresnel * axis.z;
}

// Not tuned: gaussians this wide are smooth.
constexpr int kBrdfSamples = 64;

glm::vec3 exactReading(const GaussianBasis& basis, const Amplitudes& amplitudes, Brdf brdf,
                       const Frame& shading, const Frame& texel, glm::vec3 eye) {
    brdf.diffuseColor = glm::vec3(0);
    glm::vec3 sum(0);
    for (int i = 0; i < kBrdfSamples; ++i) {
        const BrdfSample sample =
            sampleBrdf(brdf, eye, (float(i) + 0.5f) / kBrdfSamples, r2Point(i, glm::vec2(0.5f)));
        if (sample.pdf <= 0.0f) continue;
        sum += sample.weight *
               gaussianRadiance(basis, amplitudes, texel.toLocal(shading.toWorld(sample.direction)));
    }
    return sum / float(kBrdfSamples);
}

Amplitudes bakeTexel(const RayScene& rays, const LightSampler& lights, const GaussianBasis& basis,
                     const TexelPoints& points, size_t texel, const GaussianSettings& settings) {
    const Frame frame = frameFromNormalAndTangent(points.normal[texel], points.tangent[texel]);
    const glm::vec3 origin = rays.offsetOrigin(points.position[texel], points.normal[texel]);
    Rng rng(hashOf(settings.seed, kPurpose, texel));
    const glm::vec2 shift = rng.uniform2();
    Amplitudes moments{};
    for (int i = 0; i < settings.raysPerTexel; ++i) {
        const glm::vec3 local = squareToHemisphere(r2Point(i, shift));
        const glm::vec3 radiance =
            traceIncident({rays, lights}, {origin, glm::normalize(frame.toWorld(local))}, settings.paths,
                          Rng(hashOf(settings.seed, texel, uint64_t(i))))
                .reflected;
        for (int g = 0; g < kGaussians; ++g) moments[size_t(g)] += gaussianAt(basis, g, local) * radiance;
    }
    for (glm::vec3& moment : moments) moment *= 2.0f * kPi / float(settings.raysPerTexel);
    Amplitudes amplitudes = fitGaussians(basis, moments);
    for (glm::vec3& amplitude : amplitudes) amplitude = unpackRgb9e5(packRgb9e5(amplitude));
    return amplitudes;
}

}  // namespace

GaussianBasis hemisphereGaussians() {
    GaussianBasis basis;
    constexpr float kGoldenAngle = 2.39996323f;
    for (int i = 0; i < kGaussians; ++i) {
        const float z = 1.0f - (float(i) + 0.5f) / kGaussians, r = std::sqrt(1.0f - z * z);
        basis.axis[size_t(i)] = {r * std::cos(kGoldenAngle * float(i)), r * std::sin(kGoldenAngle * float(i)),
                                 z};
    }
    float nearest = -1;
    for (int i = 0; i < kGaussians; ++i)
        for (int j = 0; j < i; ++j)
            nearest = std::max(nearest, glm::dot(basis.axis[size_t(i)], basis.axis[size_t(j)]));
    const float cosHalf = std::sqrt(0.5f * (1.0f + nearest));
    basis.sharpness = std::log(kCrossing) / (cosHalf - 1.0f);

    constexpr int kSide = 256;
    for (auto& row : basis.products) row.fill(0);
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const glm::vec3 direction = squareToHemisphere((glm::vec2(x, y) + 0.5f) / float(kSide));
            for (int i = 0; i < kGaussians; ++i)
                for (int j = 0; j < kGaussians; ++j)
                    basis.products[size_t(i)][size_t(j)] += gaussianAt(basis, i, direction) *
                                                            gaussianAt(basis, j, direction) * 2.0f * kPi /
                                                            float(kSide * kSide);
        }
    }
    return basis;
}

Amplitudes fitGaussians(const GaussianBasis& basis, const Amplitudes& moments) {
    // Gauss-Seidel on the normal equations, held at 0: it converges to the constrained minimum, for the
    // products are positive definite.
    constexpr int kRounds = 200;
    Amplitudes amplitudes{};
    for (int round = 0; round < kRounds; ++round) {
        for (size_t i = 0; i < kGaussians; ++i) {
            glm::vec3 rest = moments[i];
            for (size_t j = 0; j < kGaussians; ++j)
                if (j != i) rest -= basis.products[i][j] * amplitudes[j];
            amplitudes[i] = glm::max(rest / basis.products[i][i], glm::vec3(0));
        }
    }
    return amplitudes;
}

glm::vec3 gaussianRadiance(const GaussianBasis& basis, const Amplitudes& amplitudes, glm::vec3 direction) {
    glm::vec3 sum(0);
    for (int i = 0; i < kGaussians; ++i) sum += amplitudes[size_t(i)] * gaussianAt(basis, i, direction);
    return sum;
}

GaussianLightmap bakeGaussians(const RayScene& rays, const LightSampler& lights, uint32_t material,
                               const GaussianSettings& settings, Progress& progress) {
    const Scene& scene = rays.scene();
    GaussianLightmap lightmap;
    lightmap.basis = hemisphereGaussians();
    AtlasSettings atlas;
    atlas.texelSizeMeters = settings.texelSizeMeters;
    atlas.glossyDensity = 1;
    lightmap.atlas = buildAtlas(scene, {}, atlas, progress);
    lightmap.points = buildTexelPoints(scene, lightmap.atlas);
    markOccludedTexels(lightmap.points, lightmap.atlas, rays, progress);
    lightmap.texels.resize(lightmap.atlas.texelCount());

    std::vector<size_t> wanted;
    for (size_t texel = 0; texel < lightmap.texels.size(); ++texel) {
        const TexelPoints& points = lightmap.points;
        if (!points.valid(texel) || materialAt(scene, points.triangle[texel]) != material) continue;
        wanted.push_back(texel);
        if (points.state[texel] == TexelState::surface) ++lightmap.texelCount;
    }
    const ProgressStage stage(progress, "gaussians", wanted.size());
    parallelRanges(wanted.size(), 16, progress, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            lightmap.texels[wanted[i]] =
                bakeTexel(rays, lights, lightmap.basis, lightmap.points, wanted[i], settings);
    });
    return lightmap;
}

glm::vec3 shadeByGaussians(const GaussianLightmap& lightmap, const Hit& hit, const SurfacePoint& point,
                           glm::vec3 towardEye, GaussianReading reading) {
    const Read read = readTexels(lightmap, hit);
    const glm::vec3 eye = point.shading.toLocal(towardEye);
    if (!read.found || eye.z <= 0.0f) return glm::vec3(0);
    if (reading == GaussianReading::exact)
        return exactReading(lightmap.basis, read.amplitudes, point.brdf, point.shading, read.frame, eye);
    // The gaussians' frame with the shading normal: on flat surfaces they are one.
    const Frame frame = frameFromNormalAndTangent(point.shading.normal, read.frame.tangent);
    return warpedReading(lightmap.basis, read.amplitudes, point.brdf, frame.toLocal(towardEye));
}

}  // namespace phat::peers
