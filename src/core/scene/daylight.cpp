#include "core/scene/daylight.h"

namespace phat {
namespace {

constexpr float kLumensPerWatt = 683;

// The sky is smooth: rows of 1.4 degrees.
constexpr int kSkyWidth = 256, kSkyHeight = 128;

// Perez' distribution: (1 + a exp(b / cos theta)) (1 + c exp(d gamma) + e cos^2 gamma). Preetham et al.,
// A.2.
struct Perez {
    double a, b, c, d, e;

    double operator()(double cosTheta, double gamma) const {
        return (1 + a * std::exp(b / std::max(cosTheta, 1e-4))) *
               (1 + c * std::exp(d * gamma) + e * std::pow(std::cos(gamma), 2));
    }
};

struct ZenithColor {
    double x, y, nit;
};

ZenithColor zenithColor(double t, double s) {
    const double s2 = s * s, s3 = s2 * s, chi = (4.0 / 9 - t / 120) * (double(kPi) - 2 * s);
    const double kiloNit = (4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192;
    return {t * t * (0.00166 * s3 - 0.00375 * s2 + 0.00209 * s) +
                t * (-0.02903 * s3 + 0.06377 * s2 - 0.03202 * s + 0.00394) +
                (0.11693 * s3 - 0.21196 * s2 + 0.06052 * s + 0.25886),
            t * t * (0.00275 * s3 - 0.00610 * s2 + 0.00317 * s) +
                t * (-0.04214 * s3 + 0.08970 * s2 - 0.04153 * s + 0.00516) +
                (0.15346 * s3 - 0.26756 * s2 + 0.06670 * s + 0.26688),
            // The fit falls below 0 for a clear sky with a low sun.
            1e3 * std::max(kiloNit, 0.01)};
}

// Linear Rec. 709 of chromaticity and luminance. source: ITU-R BT.709, by way of CIE XYZ.
glm::vec3 rgbOf(double x, double y, double luminance) {
    const double bigX = x * luminance / y, bigZ = (1 - x - y) * luminance / y;
    const glm::dvec3 rgb(3.2404542 * bigX - 1.5371385 * luminance - 0.4985314 * bigZ,
                         -0.9692660 * bigX + 1.8760108 * luminance + 0.0415560 * bigZ,
                         0.0556434 * bigX - 0.2040259 * luminance + 1.0572252 * bigZ);
    return glm::max(glm::vec3(rgb), glm::vec3(0));
}

class Sky {
  public:
    explicit Sky(const Daylight& day)
        : sun_(towardSun(day.sun)), zenith_(zenithColor(double(day.turbidity), std::acos(double(sun_.y)))) {
        const double t = double(day.turbidity);
        luminance_ = {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                      -0.0670 * t + 0.3703};
        x_ = {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
              -0.0033 * t + 0.0452};
        y_ = {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
              -0.0109 * t + 0.0529};
    }

    glm::vec3 radiance(glm::vec3 direction) const {
        const double cosTheta = double(direction.y);
        const double gamma = std::acos(std::clamp(double(glm::dot(direction, sun_)), -1.0, 1.0));
        const double sunTheta = std::acos(double(sun_.y));
        const auto along = [&](const Perez& perez) { return perez(cosTheta, gamma) / perez(1, sunTheta); };
        return rgbOf(zenith_.x * along(x_), zenith_.y * along(y_), zenith_.nit * along(luminance_)) /
               kLumensPerWatt;
    }

  private:
    glm::vec3 sun_;
    ZenithColor zenith_;
    Perez luminance_{}, x_{}, y_{};
};

}  // namespace

glm::vec3 skyRadiance(const Daylight& day, glm::vec3 direction) {
    return Sky(day).radiance(direction);
}

glm::vec3 sunIrradiance(const Daylight& day) {
    // Outside the atmosphere, 128,000 lux [Preetham et al. 1999]; taken to be as white as Rec. 709's white.
    constexpr double kExtraterrestrialLux = 128'000;
    // Micrometres: near the middle of what each channel of Rec. 709 stands for.
    constexpr double kWavelength[3] = {0.61, 0.55, 0.465};
    const double elevation = double(day.sun.elevationDegrees);
    const double airMass =
        1 / (double(towardSun(day.sun).y) + 0.15 * std::pow(std::max(elevation, 0.0) + 3.885, -1.253));
    const double haze = 0.04608 * double(day.turbidity) - 0.04586;
    glm::vec3 irradiance(0);
    for (int c = 0; c < 3; ++c) {
        // Rayleigh scattering and aerosols of Angstrom's law. Ozone, water and mixed gases, which take less
        // than 5 % of visible light from a high sun, are left out.
        const double depth =
            0.008735 * std::pow(kWavelength[c], -4.08) + haze * std::pow(kWavelength[c], -1.3);
        irradiance[c] = float(kExtraterrestrialLux / double(kLumensPerWatt) * std::exp(-depth * airMass));
    }
    return irradiance;
}

PunctualLight sunLight(const Daylight& day) {
    PunctualLight light;
    light.type = PunctualLight::Type::directional;
    light.intensity = sunIrradiance(day);
    light.direction = -towardSun(day.sun);
    light.angularRadius = kSunAngularRadius;
    return light;
}

Environment skyEnvironment(const Daylight& day) {
    const Sky sky(day);
    Environment environment{Image(kSkyWidth, kSkyHeight)};
    glm::dvec3 onPlain = double(towardSun(day.sun).y) * glm::dvec3(sunIrradiance(day));
    const double step = double(kPi) / kSkyHeight;
    for (int y = 0; y < kSkyHeight / 2; ++y) {
        // Integral of cos theta over one texel's solid angle.
        const double cosines = 0.5 *
                               (std::pow(std::sin((y + 1) * step), 2) - std::pow(std::sin(y * step), 2)) * 2 *
                               double(kPi) / kSkyWidth;
        const double theta = (y + 0.5) * step;
        for (int x = 0; x < kSkyWidth; ++x) {
            const double azimuth = (x + 0.5) * 2 * double(kPi) / kSkyWidth - double(kPi);
            const glm::vec3 radiance = sky.radiance(glm::vec3(
                std::sin(theta) * std::cos(azimuth), std::cos(theta), std::sin(theta) * std::sin(azimuth)));
            environment.radiance.at(x, y) = radiance;
            onPlain += cosines * glm::dvec3(radiance);
        }
    }
    const glm::vec3 ground = kGroundReflectance / kPi * glm::vec3(onPlain);
    std::fill(environment.radiance.pixels.begin() + ptrdiff_t(kSkyWidth) * (kSkyHeight / 2),
              environment.radiance.pixels.end(), ground);
    return environment;
}

}  // namespace phat
