#include "core/bake/side_sight.h"

#include <algorithm>

#include "core/base/random.h"
#include "core/scene/brdf.h"

namespace phat {
namespace {

double areaOfTriangle(const Scene& scene, uint32_t triangle) {
    const glm::uvec3& t = scene.triangles[triangle];
    const double area = 0.5 * double(glm::length(glm::cross(scene.positions[t.y] - scene.positions[t.x],
                                                            scene.positions[t.z] - scene.positions[t.x])));
    return area > 0 ? area : 0;
}

}  // namespace

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

bool isSide(const Scene& scene, const Components& components, uint32_t side) {
    const uint32_t component = side / 2;
    if (!(components.area[component] > 0)) return false;
    return !(side & 1) || scene.materialOf(components.triangle[components.first[component]]).doubleSided;
}

std::vector<uint32_t> meetsFromSide(const RayScene& rays, const Components& components, uint32_t side,
                                    const MeetsOfRay& met) {
    const Scene& scene = rays.scene();
    const uint32_t component = side / 2;
    const auto begin = components.areaUpTo.begin() + components.first[component];
    const auto end = components.areaUpTo.begin() + components.first[component + 1];
    std::vector<uint32_t> meets(kSideRays, kMeetsNothing);
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
        meets[i] = met({rays.offsetOrigin(a + b.x * e1 + b.y * e2, normal), direction});
    }
    return meets;
}

void spreadBySight(std::vector<SideState>& states, const std::vector<std::vector<uint32_t>>& meets,
                   uint32_t minSeen) {
    const auto isReached = [&](uint32_t met) {
        return met == kMeetsLight || (met != kMeetsNothing && states[met] == SideState::reached);
    };
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t s = 0; s < states.size(); ++s) {
            if (states[s] != SideState::undecided) continue;
            if (std::count_if(meets[s].begin(), meets[s].end(), isReached) < minSeen) continue;
            states[s] = SideState::reached;
            changed = true;
        }
    }
}

std::vector<Sides> reachedSides(const std::vector<SideState>& states) {
    std::vector<Sides> result(states.size() / 2, Sides::front);
    for (size_t c = 0; c < result.size(); ++c)
        if (states[2 * c + 1] == SideState::reached)
            result[c] = states[2 * c] == SideState::reached ? Sides::both : Sides::back;
    return result;
}

std::vector<NeededSides> neededSides(const std::vector<SideState>& states) {
    std::vector<NeededSides> result(states.size() / 2);
    for (size_t c = 0; c < result.size(); ++c)
        result[c] = {states[2 * c] == SideState::reached, states[2 * c + 1] == SideState::reached};
    return result;
}

}  // namespace phat
