#include "core/scene/environment_sampling.h"

#include <algorithm>
#include <cassert>

namespace phat {
namespace {

// Picture coordinates in texels: column 0 begins at azimuth -pi, row 0 at +Y.
glm::vec2 directionToPicture(glm::vec3 direction, int width, int height) {
    const float azimuth = std::atan2(direction.z, direction.x);
    const float polar = std::acos(std::clamp(direction.y, -1.0f, 1.0f));
    return {(azimuth / (2 * kPi) + 0.5f) * float(width), polar / kPi * float(height)};
}

// How much the rows above, at and below y give to the integral of the bilinear radiance over row y, per
// radian of azimuth: integrals of the interpolation weight times sin(theta) over the two halves of the row.
struct RowWeights {
    double above = 0, centre = 0, below = 0;
};

RowWeights rowWeights(int y, int height) {
    const double step = double(kPi) / height, top = y * step, middle = top + step / 2, bottom = top + step;
    const auto zeroth = [](double a, double b) { return std::cos(a) - std::cos(b); };  // of sin
    const auto first = [](double a, double b) {                                        // of theta sin
        return std::sin(b) - b * std::cos(b) - std::sin(a) + a * std::cos(a);
    };
    RowWeights weights;
    weights.above = (middle * zeroth(top, middle) - first(top, middle)) / step;
    weights.below = (first(middle, bottom) - middle * zeroth(middle, bottom)) / step;
    weights.centre = zeroth(top, bottom) - weights.above - weights.below;
    return weights;
}

}  // namespace

glm::vec3 environmentRadiance(const Environment& environment, glm::vec3 direction) {
    assert(isUnit(direction));
    const Image& image = environment.radiance;
    assert(image.width > 0 && image.height > 0);
    const glm::vec2 p = directionToPicture(direction, image.width, image.height) - 0.5f;
    const float left = std::floor(p.x), top = std::floor(p.y);
    const int x0 = (int(left) + image.width) % image.width, x1 = (x0 + 1) % image.width;
    const int y0 = std::clamp(int(top), 0, image.height - 1);
    const int y1 = std::clamp(int(top) + 1, 0, image.height - 1);
    const glm::vec3 upper = glm::mix(image.at(x0, y0), image.at(x1, y0), p.x - left);
    const glm::vec3 lower = glm::mix(image.at(x0, y1), image.at(x1, y1), p.x - left);
    return glm::mix(upper, lower, p.y - top);
}

Environment turned(const Environment& environment, int columns) {
    const Image& from = environment.radiance;
    Environment out{Image(from.width, from.height)};
    const int shift = ((columns % from.width) + from.width) % from.width;
    for (int y = 0; y < from.height; ++y) {
        const auto row = from.pixels.begin() + ptrdiff_t(y) * from.width;
        std::rotate_copy(row, row + (from.width - shift) % from.width, row + from.width,
                         &out.radiance.at(0, y));
    }
    return out;
}

EnvironmentDistribution::EnvironmentDistribution(const Environment& environment)
    : width_(environment.radiance.width), height_(environment.radiance.height) {
    const Image& image = environment.radiance;
    assert(width_ > 0 && height_ > 0);
    std::vector<double> rowLight(height_);
    cumulative_.resize(size_t(width_ + 1) * height_);
    glm::dvec3 integral(0);
    std::vector<glm::dvec3> column(width_);
    for (int y = 0; y < height_; ++y) {
        const RowWeights weights = rowWeights(y, height_);
        const int above = std::max(y - 1, 0), below = std::min(y + 1, height_ - 1);
        for (int x = 0; x < width_; ++x) {
            column[x] = weights.above * glm::dvec3(image.at(x, above)) +
                        weights.centre * glm::dvec3(image.at(x, y)) +
                        weights.below * glm::dvec3(image.at(x, below));
            integral += column[x] * (2.0 * double(kPi) / width_);
        }
        float* row = &cumulative_[size_t(width_ + 1) * y];
        double sum = 0;
        for (int x = 0; x < width_; ++x) {
            // The same interpolation along the azimuth, where sin(theta) does not vary: 1/8, 3/4, 1/8.
            const glm::dvec3 light =
                0.75 * column[x] + 0.125 * (column[(x + width_ - 1) % width_] + column[(x + 1) % width_]);
            sum += std::max(0.0, double(luminance(glm::vec3(light))));
            row[x + 1] = float(sum);
        }
        rowLight[y] = sum;
        for (int x = 1; x <= width_; ++x) row[x] = sum > 0 ? float(row[x] / sum) : 0.0f;
    }
    rows_ = DiscreteDistribution(rowLight);
    integratedRadiance_ = glm::vec3(integral);
}

float EnvironmentDistribution::rowSolidAngle(int y) const {
    const double step = double(kPi) / height_;
    return float((std::cos(y * step) - std::cos((y + 1) * step)) * 2.0 * double(kPi) / width_);
}

EnvironmentSample EnvironmentDistribution::sample(glm::vec2 square) const {
    if (black()) return {};
    const DiscreteDistribution::Choice choice = rows_.choose(square.y);
    const int y = int(choice.index);
    const float* row = &cumulative_[size_t(width_ + 1) * y];
    const int x = std::min(int(std::upper_bound(row + 1, row + width_ + 1, square.x) - row) - 1, width_ - 1);
    const float chance = row[x + 1] - row[x];
    if (!(chance > 0)) return {};

    const float acrossTexel = std::clamp((square.x - row[x]) / chance, 0.0f, 1.0f);
    const double step = double(kPi) / height_;
    const double cosTop = std::cos(y * step), cosBottom = std::cos((y + 1) * step);
    const double cosPolar = cosTop + choice.within * (cosBottom - cosTop);
    const double sinPolar = std::sqrt(std::max(0.0, 1.0 - cosPolar * cosPolar));
    const double azimuth = (double(x) + acrossTexel) * 2.0 * double(kPi) / width_ - double(kPi);
    EnvironmentSample sample;
    sample.direction = glm::vec3(sinPolar * std::cos(azimuth), cosPolar, sinPolar * std::sin(azimuth));
    sample.pdf = float(rows_.probability(choice.index)) * chance / rowSolidAngle(y);
    return sample;
}

float EnvironmentDistribution::pdf(glm::vec3 direction) const {
    if (black()) return 0.0f;
    const glm::vec2 p = directionToPicture(direction, width_, height_);
    const int x = std::clamp(int(p.x), 0, width_ - 1), y = std::clamp(int(p.y), 0, height_ - 1);
    const float* row = &cumulative_[size_t(width_ + 1) * y];
    return float(rows_.probability(y)) * (row[x + 1] - row[x]) / rowSolidAngle(y);
}

}  // namespace phat
