#pragma once
// Where the sun stands.
//
// World space has +Y up. North is -Z and east +X, as Blender's exporter makes them of its +Y and +X.

#include "core/base/math.h"

namespace phat {

/// Azimuth clockwise from north as seen from above (east 90), elevation above the horizon.
struct SunPosition {
    float azimuthDegrees = 210;
    float elevationDegrees = 40;
};

/// Unit.
glm::vec3 towardSun(const SunPosition& sun);

/// Geometric position, without refraction, to about .01 degrees for years near 2000. `julianDay` is of
/// universal time; longitude grows eastward. source: Meeus 1998, "Astronomical Algorithms", chapter 25 (low
/// precision) and 28 (equation of time), in the form of NOAA's solar calculator.
SunPosition sunPositionAt(double julianDay, double latitudeDegrees, double longitudeDegrees);

}  // namespace phat
