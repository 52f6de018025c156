#pragma once
// Irradiance as a function of the normal, to the first order of spherical harmonics, at many points.

#include <array>
#include <vector>

#include "core/base/math.h"

namespace phat {

/// [y][x] of an atlas each, W/m2: the irradiance of normal n is term[0] + n.x term[1] + n.y term[2] + n.z
/// term[3], in world space. Of light w of flux density f on a plane that faces it, the terms are f/4 and
/// f/2 w. source: Ramamoorthi and Hanrahan 2001, to order 1.
struct IrradianceTerms {
    std::array<std::vector<glm::vec3>, 4> term;

    explicit IrradianceTerms(size_t texels) { term.fill(std::vector<glm::vec3>(texels, glm::vec3(0))); }
    void addLight(size_t texel, glm::vec3 direction, glm::vec3 fluxDensity) {
        term[0][texel] += 0.25f * fluxDensity;
        for (int axis = 0; axis < 3; ++axis)
            term[size_t(axis) + 1][texel] += 0.5f * direction[axis] * fluxDensity;
    }
    glm::vec3 at(size_t texel, glm::vec3 normal) const {
        glm::vec3 sum = term[0][texel];
        for (int axis = 0; axis < 3; ++axis) sum += normal[axis] * term[size_t(axis) + 1][texel];
        return sum;
    }
};

}  // namespace phat
