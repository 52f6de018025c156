#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/random.h"
#include "core/render/metrics.h"

namespace phat {
namespace {

// The published formulas as they stand: double precision, two-dimensional filters, no product form.
namespace plain {

using Vec = std::array<double, 3>;
constexpr double kPixelsPerDegree = 67;
constexpr Vec kWhite{0.950428545, 1.0, 1.088900371};
constexpr double kXyz[3][3] = {{0.412390799, 0.357584339, 0.180480788},
                               {0.212639006, 0.715168679, 0.072192315},
                               {0.019330819, 0.119194780, 0.950532152}};
// IEC 61966-2-1's inverse.
constexpr double kRgb[3][3] = {{3.240969942, -1.537383178, -0.498610760},
                               {-0.969243636, 1.875967502, 0.041555057},
                               {0.055630080, -0.203976959, 1.056971514}};

Vec multiply(const double (&m)[3][3], Vec v) {
    Vec out{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) out[i] += m[i][j] * v[j];
    return out;
}

Vec ycxcz(Vec rgb) {
    Vec xyz = multiply(kXyz, rgb);
    for (int i = 0; i < 3; ++i) xyz[i] /= kWhite[i];
    return {116 * xyz[1] - 16, 500 * (xyz[0] - xyz[1]), 200 * (xyz[1] - xyz[2])};
}

Vec rgbFromYcxcz(Vec c) {
    const double y = (c[0] + 16) / 116;
    return multiply(kRgb, {(y + c[1] / 500) * kWhite[0], y * kWhite[1], (y - c[2] / 200) * kWhite[2]});
}

Vec huntLab(Vec rgb) {
    Vec f = multiply(kXyz, rgb);
    for (int i = 0; i < 3; ++i) {
        const double t = f[i] / kWhite[i];
        f[i] = t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116;
    }
    const double lightness = 116 * f[1] - 16;
    return {lightness, 5 * lightness * (f[0] - f[1]), 2 * lightness * (f[1] - f[2])};
}

double hyab(Vec a, Vec b) {
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

double colorError(Vec labA, Vec labB) {
    const double largest = std::pow(hyab(huntLab({0, 1, 0}), huntLab({0, 0, 1})), 0.7);
    const double difference = std::pow(hyab(labA, labB), 0.7), knee = 0.4 * largest;
    return difference < knee ? difference / knee * 0.95
                             : 0.95 + (difference - knee) / (largest - knee) * 0.05;
}

struct Filter {
    int radius;
    std::vector<double> taps;  // [y][x]
};

template <typename Weight>
Filter filterOf(int radius, Weight weight) {
    Filter filter{radius, {}};
    for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x) filter.taps.push_back(weight(x, y));
    double positive = 0, negative = 0;
    for (const double tap : filter.taps) (tap > 0 ? positive : negative) += tap;
    for (double& tap : filter.taps) tap /= tap > 0 ? positive : -negative;
    return filter;
}

Vec apply(const std::vector<Vec>& in, int width, int height, int x0, int y0,
          const std::array<Filter, 3>& filters) {
    Vec sum{};
    for (int c = 0; c < 3; ++c) {
        const int r = filters[c].radius;
        const double* tap = filters[c].taps.data();
        for (int y = y0 - r; y <= y0 + r; ++y)
            for (int x = x0 - r; x <= x0 + r; ++x)
                sum[c] += *tap++ *
                          in[size_t(std::clamp(y, 0, height - 1)) * width + std::clamp(x, 0, width - 1)][c];
    }
    return sum;
}

std::array<Filter, 3> sensitivity() {
    const int radius = int(std::ceil(3 * std::sqrt(0.04 / (2 * M_PI * M_PI)) * kPixelsPerDegree));
    const auto term = [](double a, double b, int x, int y) {
        const double d2 = (x * x + y * y) / (kPixelsPerDegree * kPixelsPerDegree);
        return a * std::sqrt(M_PI / b) * std::exp(-M_PI * M_PI * d2 / b);
    };
    return {filterOf(radius, [&](int x, int y) { return term(1, 0.0047, x, y); }),
            filterOf(radius, [&](int x, int y) { return term(1, 0.0053, x, y); }),
            filterOf(radius, [&](int x, int y) { return term(34.1, 0.04, x, y) + term(13.5, 0.025, x, y); })};
}

// Derivatives of order 1 or 2 along x or y of a Gaussian of half the feature's width.
Filter derivative(int order, bool alongY) {
    const double deviation = 0.5 * 0.082 * kPixelsPerDegree;
    return filterOf(int(std::ceil(3 * deviation)), [=](int x, int y) {
        const double along = (alongY ? y : x) / deviation;
        const double gauss = std::exp(-(x * x + y * y) / (2 * deviation * deviation));
        return gauss * (order == 1 ? -along : along * along - 1);
    });
}

std::vector<double> flip(const Image& test, const Image& reference) {
    const int width = reference.width, height = reference.height;
    const auto csf = sensitivity();
    std::array<Filter, 4> features;
    for (int i = 0; i < 4; ++i) features[i] = derivative(1 + i / 2, i % 2);

    std::array<std::vector<Vec>, 2> opponent, luminance;
    for (int i = 0; i < 2; ++i)
        for (const glm::vec3& p : (i ? reference : test).pixels) {
            opponent[i].push_back(ycxcz({p.x, p.y, p.z}));
            luminance[i].push_back({(opponent[i].back()[0] + 16) / 116, 0, 0});
        }
    std::vector<double> errors;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            std::array<Vec, 2> lab;
            double edge[2], point[2];
            for (int i = 0; i < 2; ++i) {
                Vec rgb = rgbFromYcxcz(apply(opponent[i], width, height, x, y, csf));
                for (double& channel : rgb) channel = std::clamp(channel, 0.0, 1.0);
                lab[i] = huntLab(rgb);
                double strength[4];
                for (int k = 0; k < 4; ++k)
                    strength[k] =
                        apply(luminance[i], width, height, x, y, {features[k], {0, {0}}, {0, {0}}})[0];
                edge[i] = std::hypot(strength[0], strength[1]);
                point[i] = std::hypot(strength[2], strength[3]);
            }
            const double feature = std::sqrt(
                std::max(std::abs(edge[0] - edge[1]), std::abs(point[0] - point[1])) / std::sqrt(2.0));
            errors.push_back(std::pow(colorError(lab[0], lab[1]), 1 - feature));
        }
    return errors;
}

}  // namespace plain

Image noise(int width, int height, uint64_t seed) {
    Rng rng(seed);
    Image image(width, height);
    for (glm::vec3& pixel : image.pixels) pixel = {rng.uniform(), rng.uniform(), rng.uniform()};
    return image;
}

// Something with flat parts, edges and single bright pixels.
Image drawing(int width, int height) {
    Image image(width, height, {0.2f, 0.3f, 0.25f});
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (x > width / 3 && y < height / 2) image.at(x, y) = {0.9f, 0.5f, 0.1f};
            if (x % 11 == 5 && y % 7 == 3) image.at(x, y) = {0.1f, 0.2f, 1};
        }
    return image;
}

double mean(const std::vector<float>& values) {
    double sum = 0;
    for (const float value : values) sum += value;
    return sum / double(values.size());
}

TEST(Flip, AgreesWithTheFormulasWithoutShortcuts) {
    const Image pairs[][2] = {{noise(24, 17, 1), noise(24, 17, 2)},
                              {drawing(30, 23), Image(30, 23, {0.3f, 0.3f, 0.3f})},
                              {drawing(30, 23), noise(30, 23, 5)}};
    for (const auto& [test, reference] : pairs) {
        const std::vector<float> fast = flipMap(test, reference);
        const std::vector<double> slow = plain::flip(test, reference);
        ASSERT_EQ(fast.size(), slow.size());
        // Single precision: Y = 100 carries 6e-6, which the exponents .7 and .5 magnify near zero.
        for (size_t i = 0; i < fast.size(); ++i) ASSERT_NEAR(fast[i], slow[i], 2e-4) << i;
    }
}

// Flat pictures have no features and nothing to filter: only the colour difference is left.
TEST(Flip, FlatPicturesHaveTheColourErrorAlone) {
    const glm::vec3 colors[] = {{0, 0, 0},          {1, 1, 1},           {1, 0, 0},
                                {0, 1, 0},          {0, 0, 1},           {0.5f, 0.5f, 0.5f},
                                {0.2f, 0.7f, 0.1f}, {0.52f, 0.5f, 0.5f}, {0.01f, 0.02f, 0.0f}};
    for (const glm::vec3 a : colors)
        for (const glm::vec3 b : colors) {
            const double expected =
                plain::colorError(plain::huntLab({a.x, a.y, a.z}), plain::huntLab({b.x, b.y, b.z}));
            const std::vector<float> map = flipMap(Image(6, 5, a), Image(6, 5, b));
            for (const float error : map) ASSERT_NEAR(error, expected, 5e-4);
        }
}

TEST(Flip, KnownColourErrors) {
    const auto flat = [](glm::vec3 a, glm::vec3 b) { return flipMap(Image(1, 1, a), Image(1, 1, b))[0]; };
    EXPECT_NEAR(flat({0, 1, 0}, {0, 0, 1}), 1.0f, 1e-5f);  // defined as the largest
    // By hand: |dL*| = 100 to the .7 = 25.119; green to blue 203.3 to the .7 = 41.3; .95 + .05 (25.1 - 16.5)
    // / 24.8.
    EXPECT_NEAR(flat({0, 0, 0}, {1, 1, 1}), 0.967f, 1e-3f);
}

TEST(Flip, EqualPicturesAreZero) {
    const Image image = noise(40, 30, 1);
    for (const float error : flipMap(image, image)) ASSERT_EQ(error, 0.0f);
}

TEST(Flip, OrderOfThePicturesDoesNotMatter) {
    const Image a = drawing(40, 30), b = noise(40, 30, 2);
    EXPECT_EQ(flipMap(a, b), flipMap(b, a));
}

TEST(Flip, StaysBetweenZeroAndOne) {
    Image extreme = noise(40, 30, 3);
    for (glm::vec3& pixel : extreme.pixels) pixel = (pixel - 0.5f) * 1e6f;
    for (const Image& other : {Image(40, 30), Image(40, 30, glm::vec3(1)), drawing(40, 30)})
        for (const float error : flipMap(extreme, other)) {
            ASSERT_GE(error, 0.0f);
            ASSERT_LE(error, 1.0f);
        }
}

TEST(Flip, ValuesBeyondTheScreenAreClamped) {
    EXPECT_EQ(mean(flipMap(Image(8, 8, {7, -2, 1}), Image(8, 8, {1, 0, 90}))), 0);
}

TEST(Flip, GrowsWithTheDistortion) {
    const Image reference = drawing(64, 48), disturbance = noise(64, 48, 4);
    double last = 0;
    for (const float amount : {0.02f, 0.05f, 0.1f, 0.2f, 0.4f}) {
        Image test = reference;
        for (size_t i = 0; i < test.pixels.size(); ++i)
            test.pixels[i] += amount * (disturbance.pixels[i] - 0.5f);
        const double error = mean(flipMap(test, reference));
        EXPECT_GT(error, last) << amount;
        last = error;
    }
}

// Fine noise that the eye averages disturbs less than the same differences in large patches.
TEST(Flip, FineDifferencesCountLessThanCoarse) {
    const Image gray(96, 96, glm::vec3(0.4f));
    Image fine = gray, coarse = gray;
    for (int y = 0; y < 96; ++y)
        for (int x = 0; x < 96; ++x) {
            fine.at(x, y) += ((x + y) % 2 ? 0.1f : -0.1f);
            coarse.at(x, y) += ((x / 24 + y / 24) % 2 ? 0.1f : -0.1f);
        }
    EXPECT_LT(mean(flipMap(fine, gray)), 0.25 * mean(flipMap(coarse, gray)));
}

// Pictures go on beyond their edges as their edge pixels do, so that adding those changes nothing inside.
TEST(Flip, RepeatedEdgesChangeNothing) {
    const Image test = drawing(33, 21), reference = noise(33, 21, 6);
    constexpr int kBorder = 9;
    const auto extend = [](const Image& image) {
        Image out(image.width + 2 * kBorder, image.height + 2 * kBorder);
        for (int y = 0; y < out.height; ++y)
            for (int x = 0; x < out.width; ++x)
                out.at(x, y) = image.at(std::clamp(x - kBorder, 0, image.width - 1),
                                        std::clamp(y - kBorder, 0, image.height - 1));
        return out;
    };
    const auto small = flipMap(test, reference), large = flipMap(extend(test), extend(reference));
    for (int y = 0; y < 21; ++y)
        for (int x = 0; x < 33; ++x)
            ASSERT_EQ(small[size_t(y) * 33 + x],
                      large[size_t(y + kBorder) * (33 + 2 * kBorder) + x + kBorder]);
}

}  // namespace
}  // namespace phat
