#include "core/bake/lit_sides.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/base/hemisphere_map.h"
#include "core/base/median.h"
#include "core/base/random.h"
#include "core/scene/glass.h"

namespace phat {
namespace {

/// When a side is lit.
struct Limits {
    // Of the scene's usual irradiance: with so much, and of so many photons that they are no leak.
    double fraction;
    uint32_t photons;
    // Of kSideRays, that meet a lit side. A crack of a millimetre in a wall of two metres lets one in a
    // thousand through.
    uint32_t seen;
};
constexpr Limits kLit{0.002, 4, 2}, kClearlyLit{0.02, 40, 20};

// A side that no photon found is dark without further ado if the other side has so many.
constexpr uint32_t kEnoughPhotons = 256;
// The other sides ask what they see: rays a side.
constexpr uint32_t kSideRays = 128;

// What a ray meets if not a side: darkness, or a light in the environment.
constexpr uint32_t kNothing = ~0u, kSky = ~0u - 1;

/// A side of a component; the numbers of a component's sides are 2 c and 2 c + 1, the front first.
struct Side {
    double fluxWatts = 0;
    uint32_t photons = 0;
    std::vector<uint32_t> seen;  // of the undecided: the sides that its rays meet
};

enum class Light : uint8_t { dark, undecided, lit };

struct Components {
    std::vector<uint32_t> ofTriangle;
    std::vector<uint32_t> first, triangle;  // triangles listed by component
    std::vector<double> area;               // per component, square metres
    std::vector<double> areaUpTo;           // per element of `triangle`: of its component, itself included

    uint32_t count() const { return uint32_t(area.size()); }
};

double areaOfTriangle(const Scene& scene, uint32_t triangle) {
    const glm::uvec3& t = scene.triangles[triangle];
    const double area = 0.5 * double(glm::length(glm::cross(scene.positions[t.y] - scene.positions[t.x],
                                                            scene.positions[t.z] - scene.positions[t.x])));
    return area > 0 ? area : 0;
}

Components findComponents(const Scene& scene) {
    Components result;
    result.ofTriangle = connectedComponents(scene);
    const std::vector<uint32_t>& of = result.ofTriangle;
    const uint32_t count = of.empty() ? 0 : *std::max_element(of.begin(), of.end()) + 1;
    result.area.assign(count, 0);
    result.first.assign(count + 1, 0);
    for (const uint32_t c : of) ++result.first[c + 1];
    for (uint32_t c = 0; c < count; ++c) result.first[c + 1] += result.first[c];
    result.triangle.resize(of.size());
    result.areaUpTo.resize(of.size());
    std::vector<uint32_t> next(result.first.begin(), result.first.end() - 1);
    for (uint32_t t = 0; t < of.size(); ++t) {
        const uint32_t c = of[t];
        result.area[c] += areaOfTriangle(scene, t);
        result.areaUpTo[next[c]] = result.area[c];
        result.triangle[next[c]++] = t;
    }
    return result;
}

/// W/m2: the median over the area of what the brighter sides receive. A mean would be that of the inside of
/// the brightest lamp shade.
double usualIrradiance(const Components& components, const std::vector<Side>& sides) {
    std::vector<std::pair<double, double>> lit;  // irradiance, area
    for (uint32_t c = 0; c < components.count(); ++c) {
        const double flux = std::max(sides[2 * c].fluxWatts, sides[2 * c + 1].fluxWatts);
        if (flux > 0 && components.area[c] > 0)
            lit.emplace_back(flux / components.area[c], components.area[c]);
    }
    return weightedMedianOf(std::move(lit));
}

/// The sides that cosine-distributed rays from everywhere on a side meet.
std::vector<uint32_t> sidesSeenFrom(const LitScene& lit, const Components& components, uint32_t side) {
    const Scene& scene = lit.rays.scene();
    const uint32_t component = side / 2;
    const auto begin = components.areaUpTo.begin() + components.first[component];
    const auto end = components.areaUpTo.begin() + components.first[component + 1];
    std::vector<uint32_t> seen(kSideRays, kNothing);
    uint64_t rayCount = 0;
    for (uint32_t i = 0; i < kSideRays; ++i) {
        Rng random(hashOf(0x51de, side, i));
        const double along = (i + double(random.uniform())) / kSideRays * components.area[component];
        const auto found = std::min(std::upper_bound(begin, end, along), end - 1);
        const uint32_t triangle = components.triangle[size_t(found - components.areaUpTo.begin())];
        const glm::uvec3& v = scene.triangles[triangle];
        const glm::vec3 a = scene.positions[v.x], e1 = scene.positions[v.y] - a,
                        e2 = scene.positions[v.z] - a;
        glm::vec3 normal = glm::normalize(glm::cross(e1, e2));
        if (!isUnit(normal)) continue;
        if (side & 1) normal = -normal;
        glm::vec2 b = random.uniform2();
        if (b.x + b.y > 1) b = 1.0f - b;
        const glm::vec3 direction =
            glm::normalize(frameFromNormal(normal).toWorld(squareToCosineHemisphere(random.uniform2())));
        const Ray toward{lit.rays.offsetOrigin(a + b.x * e1 + b.y * e2, normal), direction};
        const Hit hit = seeStraight(lit.rays, toward, kFarDistance, rayCount).hit;
        if (hit)
            seen[i] = 2 * components.ofTriangle[hit.triangle] + hit.backFace;
        else if (maxComponent(lit.lights.environmentRadiance(direction)) > 0)
            seen[i] = kSky;
    }
    return seen;
}

/// Lights the undecided sides that see lit ones, until none is left that does.
void spreadBySight(std::vector<Light>& light, const std::vector<Side>& sides, uint32_t minSeen) {
    const auto isLit = [&](uint32_t seen) {
        return seen == kSky || (seen != kNothing && light[seen] == Light::lit);
    };
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t s = 0; s < sides.size(); ++s) {
            if (light[s] != Light::undecided) continue;
            const auto& seen = sides[s].seen;
            if (std::count_if(seen.begin(), seen.end(), isLit) < minSeen) continue;
            light[s] = Light::lit;
            changed = true;
        }
    }
}

// What photons bring to the sides of the components.
std::vector<Side> sidesUnder(const PhotonMap& photons, const Components& components) {
    std::vector<Side> sides(2 * size_t(components.count()));
    for (const Photon& photon : photons.photons) {
        Side& side = sides[2 * components.ofTriangle[photon.triangle] + photon.backFace];
        side.fluxWatts += double(luminance(photon.fluxWatts));
        ++side.photons;
    }
    return sides;
}

/// Per side. What sides see is traced where it is asked for first.
std::vector<Light> lightOf(const LitScene& lit, const Components& components, std::vector<Side>& sides,
                           const Limits& limits) {
    const Scene& scene = lit.rays.scene();
    const double usual = usualIrradiance(components, sides);
    std::vector<Light> light(sides.size(), Light::dark);
    for (uint32_t s = 0; s < sides.size(); ++s) {
        const uint32_t c = s / 2;
        const bool doubleSided = scene.materialOf(components.triangle[components.first[c]]).doubleSided;
        if (!(components.area[c] > 0) || (!doubleSided && (s & 1))) continue;
        const double irradiance = sides[s].fluxWatts / components.area[c];
        const uint32_t enough = doubleSided ? limits.photons : 1;  // the front is the only side there is
        if (sides[s].photons >= enough && irradiance >= limits.fraction * usual)
            light[s] = Light::lit;
        else if (sides[s].photons > 0 || sides[s ^ 1].photons < kEnoughPhotons)
            light[s] = Light::undecided;
    }
    tbb::parallel_for(uint32_t(0), uint32_t(sides.size()), [&](uint32_t s) {
        if (light[s] == Light::undecided && sides[s].seen.empty())
            sides[s].seen = sidesSeenFrom(lit, components, s);
    });
    spreadBySight(light, sides, limits.seen);
    return light;
}

std::vector<Sides> sidesWithTexels(const std::vector<Light>& light) {
    std::vector<Sides> result(light.size() / 2, Sides::front);
    for (size_t c = 0; c < result.size(); ++c)
        if (light[2 * c + 1] == Light::lit)
            result[c] = light[2 * c] == Light::lit ? Sides::both : Sides::back;
    return result;
}

}  // namespace

std::vector<Sides> litSides(const LitScene& scene, const PhotonMap& photons,
                            std::vector<NeededSides>* clearlyLit) {
    const Components components = findComponents(scene.rays.scene());
    std::vector<Side> sides = sidesUnder(photons, components);
    const std::vector<Sides> result = sidesWithTexels(lightOf(scene, components, sides, kLit));
    if (!clearlyLit) return result;
    const std::vector<Light> clearly = lightOf(scene, components, sides, kClearlyLit);
    clearlyLit->resize(result.size());
    for (size_t c = 0; c < result.size(); ++c)
        (*clearlyLit)[c] = {clearly[2 * c] == Light::lit, clearly[2 * c + 1] == Light::lit};
    return result;
}

}  // namespace phat
