#pragma once
// Webs of candela with closed forms.

#include <functional>
#include <string>
#include <vector>

#include "core/base/math.h"
#include "core/scene/scene.h"

namespace phat::test {

/// A formula over the vertical and the horizontal angle, in radians; its largest value is 1.
struct PhotometricFormula {
    const char* name;
    std::function<double(double, double)> value;
    double solidAngle;  // its integral over the sphere
    int verticalSteps, horizontalSteps;
};

inline double cosineDown(double vertical) {
    return std::max(0.0, std::cos(vertical));
}

inline std::vector<PhotometricFormula> photometricFormulas() {
    constexpr double pi = 3.14159265358979324;
    return {
        {"isotropic", [](double, double) { return 1.0; }, 4 * pi, 1, 1},
        {"Lambertian", [](double v, double) { return cosineDown(v); }, pi, 90, 1},
        {"cosine to the 20th", [](double v, double) { return std::pow(cosineDown(v), 20); }, 2 * pi / 21, 180,
         1},
        {"wall washer",
         [](double v, double h) { return 2 * std::sin(v) * cosineDown(v) * std::cos(h) * std::cos(h); },
         2 * pi / 3, 90, 72},
        // Without a symmetry: 1 radian from where the horizontal angle is 0.
        {"lobe", [](double v, double h) { return 0.5 + 0.5 * std::sin(v) * std::cos(h - 1); }, 2 * pi, 90,
         72},
    };
}

inline Photometry photometryOf(const PhotometricFormula& formula, float peakCandela = 1) {
    PhotometricWeb web{formula.name, peakCandela, formula.verticalSteps, formula.horizontalSteps, {}};
    for (int h = 0; h < web.horizontalSteps; ++h)
        for (int v = 0; v <= web.verticalSteps; ++v)
            web.relative.push_back(float(formula.value(double(kPi) * v / web.verticalSteps,
                                                       2 * double(kPi) * h / web.horizontalSteps)));
    return Photometry(std::move(web));
}

/// Points down; its horizontal angle is 0 along +x and 90 degrees along -z.
inline PunctualLight photometricLight(SharedValue<Photometry> photometry, glm::vec3 candela,
                                      glm::vec3 position) {
    PunctualLight light;
    light.intensity = candela;
    light.position = position;
    light.direction = {0, -1, 0};
    light.photometry = std::move(photometry);
    return light;
}

}  // namespace phat::test
