#include "core/scene/sun_position.h"

namespace phat {
namespace {

constexpr double kRadians = 3.14159265358979323846 / 180;

double sine(double degrees) {
    return std::sin(degrees * kRadians);
}

double cosine(double degrees) {
    return std::cos(degrees * kRadians);
}

}  // namespace

glm::vec3 towardSun(const SunPosition& sun) {
    const double up = sine(double(sun.elevationDegrees)), along = cosine(double(sun.elevationDegrees));
    return {along * sine(double(sun.azimuthDegrees)), up, -along * cosine(double(sun.azimuthDegrees))};
}

SunPosition sunPositionAt(double julianDay, double latitudeDegrees, double longitudeDegrees) {
    const double t = (julianDay - 2451545.0) / 36525;  // centuries since 2000
    const double meanLongitude = 280.46646 + t * (36000.76983 + 0.0003032 * t);
    const double meanAnomaly = 357.52911 + t * (35999.05029 - 0.0001537 * t);
    const double eccentricity = 0.016708634 - t * (0.000042037 + 0.0000001267 * t);
    const double center = sine(meanAnomaly) * (1.914602 - t * (0.004817 + 0.000014 * t)) +
                          sine(2 * meanAnomaly) * (0.019993 - 0.000101 * t) +
                          sine(3 * meanAnomaly) * 0.000289;
    const double node = 125.04 - 1934.136 * t;
    const double longitude = meanLongitude + center - 0.00569 - 0.00478 * sine(node);
    const double obliquity = 23 + 26 / 60.0 + (21.448 - t * (46.815 + t * (0.00059 - 0.001813 * t))) / 3600 +
                             0.00256 * cosine(node);
    const double declination = std::asin(sine(obliquity) * sine(longitude));

    const double y = std::pow(std::tan(0.5 * obliquity * kRadians), 2);
    const double equationOfTime =  // radians
        y * sine(2 * meanLongitude) - 2 * eccentricity * sine(meanAnomaly) +
        4 * eccentricity * y * sine(meanAnomaly) * cosine(2 * meanLongitude) -
        0.5 * y * y * sine(4 * meanLongitude) - 1.25 * eccentricity * eccentricity * sine(2 * meanAnomaly);
    const double day = julianDay + 0.5 - std::floor(julianDay + 0.5);  // since midnight
    const double hourAngle = 360 * day - 180 + equationOfTime / kRadians + longitudeDegrees;

    const double sinElevation = sine(latitudeDegrees) * std::sin(declination) +
                                cosine(latitudeDegrees) * std::cos(declination) * cosine(hourAngle);
    const double fromSouth = std::atan2(sine(hourAngle), cosine(hourAngle) * sine(latitudeDegrees) -
                                                             std::tan(declination) * cosine(latitudeDegrees));
    const double azimuth = fromSouth / kRadians + 180;
    return {float(azimuth - 360 * std::floor(azimuth / 360)),
            float(std::asin(std::clamp(sinElevation, -1.0, 1.0)) / kRadians)};
}

}  // namespace phat
