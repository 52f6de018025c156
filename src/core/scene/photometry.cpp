#include "core/scene/photometry.h"

#include <cassert>

#include "core/base/math.h"

namespace phat {
namespace {

constexpr double kHalfTurn = 3.14159265358979324;

// Intensity over a step of the vertical angle: linear from `low` to `high`.
struct VerticalStep {
    double begin, size, low, high;  // radians, radians, intensities

    double slope() const { return (high - low) / size; }
    double value(double angle) const { return low + slope() * (angle - begin); }
    // Integral of value(angle) sin(angle) from `begin`.
    double integral(double angle) const {
        return low * std::cos(begin) - value(angle) * std::cos(angle) +
               slope() * (std::sin(angle) - std::sin(begin));
    }
    // The angle up to which the integral is `target`: Newton's method, by halves where it leaves the step.
    double angleOf(double target) const {
        double from = begin, to = begin + size, angle = begin + 0.5 * size;
        for (int i = 0; i < kMaxIterations; ++i) {
            const double excess = integral(angle) - target;
            (excess > 0 ? to : from) = angle;
            const double next = angle - excess / (value(angle) * std::sin(angle));
            const double last = angle;
            angle = next > from && next < to ? next : 0.5 * (from + to);
            if (std::abs(angle - last) < 1e-9) break;
        }
        return angle;
    }
    static constexpr int kMaxIterations = 40;
};

// Where in [0,1] a density that is linear from `low` to `high` has accumulated the fraction `unit` of itself.
double invertLinear(double low, double high, double unit) {
    const double root = std::sqrt(std::max(0.0, low * low + unit * (high * high - low * low)));
    return low + root > 0 ? unit * (low + high) / (low + root) : unit;
}

}  // namespace

Photometry::Photometry(PhotometricWeb web) : web_(std::move(web)) {
    const int rows = web_.verticalSteps, columns = web_.horizontalSteps;
    assert(web_.relative.size() == size_t(columns) * (rows + 1));
    const double step = kHalfTurn / rows;
    cumulative_.reserve(web_.relative.size());
    int lastLit = 0;
    for (int h = 0; h < columns; ++h) {
        double sum = 0;
        cumulative_.push_back(0);
        for (int v = 0; v < rows; ++v) {
            const VerticalStep across{v * step, step, point(h, v), point(h, v + 1)};
            sum += across.integral(across.begin + step);
            cumulative_.push_back(sum);
            if (across.low > 0 || across.high > 0) lastLit = std::max(lastLit, v + 1);
        }
    }
    turned_.push_back(0);
    for (int h = 0; h < columns; ++h)
        turned_.push_back(turned_.back() + 0.5 * (columnOf(h) + columnOf((h + 1) % columns)));
    solidAngle_ = float(2 * kHalfTurn / columns * turned_.back());
    darkBelowCosine_ = lastLit == rows ? -1.0f : float(std::cos(lastLit * step));
    assert(solidAngle_ > 0);
}

// twin: photometricFalloff in shaders/lib/photometry.glsl.
float Photometry::at(glm::vec3 d) const {
    const float vertical =
        std::atan2(std::sqrt(d.x * d.x + d.y * d.y), -d.z) * (float(web_.verticalSteps) / kPi);
    const int row = std::clamp(int(vertical), 0, web_.verticalSteps - 1);
    const float down = std::clamp(vertical - float(row), 0.0f, 1.0f);
    const float turn = std::atan2(d.y, d.x) / (2 * kPi);
    const float horizontal = (turn - std::floor(turn)) * float(web_.horizontalSteps);
    const int column = std::min(int(horizontal), web_.horizontalSteps - 1);
    const int next = (column + 1) % web_.horizontalSteps;
    const float along = horizontal - float(column);
    return glm::mix(glm::mix(point(column, row), point(column, row + 1), down),
                    glm::mix(point(next, row), point(next, row + 1), down), along);
}

glm::vec3 Photometry::sample(glm::vec2 square) const {
    const int rows = web_.verticalSteps, columns = web_.horizontalSteps;
    const double turned = double(square.x) * turned_.back();
    const auto after = std::upper_bound(turned_.begin() + 1, turned_.end() - 1, turned);
    const int column = int(after - turned_.begin()) - 1, next = (column + 1) % columns;
    const double width = turned_[size_t(column) + 1] - turned_[size_t(column)];
    const double unit = width > 0 ? std::clamp((turned - turned_[size_t(column)]) / width, 0.0, 1.0) : 0.0;
    const double along = invertLinear(columnOf(column), columnOf(next), unit);
    const double azimuth = (column + along) * (2 * kHalfTurn / columns);

    // Between two columns the integrals over the vertical angle are mixed as the intensities are.
    const auto mixed = [&](double a, double b) { return a + along * (b - a); };
    const auto sumTo = [&](int row) { return mixed(cumulated(column)[row], cumulated(next)[row]); };
    const double target = double(square.y) * sumTo(rows);
    int low = 0, high = rows;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        (sumTo(middle) <= target ? low : high) = middle;
    }
    const double step = kHalfTurn / rows;
    const VerticalStep across{low * step, step, mixed(point(column, low), point(next, low)),
                              mixed(point(column, low + 1), point(next, low + 1))};
    const double angle = across.angleOf(target - sumTo(low));
    const double sine = std::sin(angle);
    return {float(sine * std::cos(azimuth)), float(sine * std::sin(azimuth)), float(-std::cos(angle))};
}

float Photometry::spreadDegrees(float horizontalDegrees, float fraction) const {
    constexpr int kPlaces = 1800;  // a tenth of a degree apart
    float spread = 0;
    for (const float side : {0.0f, 180.0f}) {
        const float azimuth = glm::radians(horizontalDegrees + side);
        for (int place = kPlaces; place >= 0; --place) {
            const float angle = kPi * float(place) / kPlaces, sine = std::sin(angle);
            if (at({sine * std::cos(azimuth), sine * std::sin(azimuth), -std::cos(angle)}) < fraction)
                continue;
            spread += glm::degrees(angle);
            break;
        }
    }
    return spread;
}

}  // namespace phat
