// LDR-FLIP: how visible a difference is when two pictures alternate in place.
//
// source: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem and Fairchild 2020, "FLIP: A Difference
//         Evaluator for Alternating Images". All constants without another source are that paper's.
// All its filters are sums of products of a function of x and one of y, and run as such.

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/render/metrics.h"

namespace phat {
namespace {

using Values = std::vector<float>;  // one channel of a picture, [y][x]

constexpr float kColorExponent = 0.7f;          // q_c
constexpr float kColorKnee = 0.4f;              // p_c: of the largest colour difference ...
constexpr float kColorAtKnee = 0.95f;           // p_t: ... maps to this
constexpr float kFeatureExponent = 0.5f;        // q_f
constexpr float kFeatureWidthDegrees = 0.082f;  // w

// XYZ of sRGB's white, D65.
const glm::vec3 kWhiteXyz(0.950428545f, 1.0f, 1.088900371f);
// XYZ from linear Rec. 709, IEC 61966-2-1; columns are the primaries.
const glm::mat3 kXyzFromRgb(0.412390799f, 0.212639006f, 0.019330819f,  //
                            0.357584339f, 0.715168679f, 0.119194780f,  //
                            0.180480788f, 0.072192315f, 0.950532152f);

// YCxCz: CIELAB's axes without its cube roots, so that filtering keeps energy.
glm::vec3 ycxczFromRgb(glm::vec3 rgb) {
    const glm::vec3 xyz = kXyzFromRgb * rgb / kWhiteXyz;
    return {116 * xyz.y - 16, 500 * (xyz.x - xyz.y), 200 * (xyz.y - xyz.z)};
}

glm::vec3 xyzRelativeFromYcxcz(glm::vec3 ycxcz) {
    const float y = (ycxcz.x + 16) / 116;
    return {y + ycxcz.y / 500, y, y - ycxcz.z / 200};
}

// CIELAB of XYZ relative to white, its chroma scaled by lightness: colours differ less in the dark (Hunt).
glm::vec3 huntLab(glm::vec3 xyzRelative) {
    const auto f = [](float t) {
        constexpr float kDelta = 6.0f / 29.0f;
        return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0f / 29.0f;
    };
    const float x = f(xyzRelative.x), y = f(xyzRelative.y), z = f(xyzRelative.z);
    const float lightness = 116 * y - 16;
    return {lightness, 0.01f * lightness * 500 * (x - y), 0.01f * lightness * 200 * (y - z)};
}

glm::vec3 huntLabFromRgb(glm::vec3 rgb) {
    return huntLab(kXyzFromRgb * rgb / kWhiteXyz);
}

// Distance for large colour differences: city block in lightness, Euclidean in chroma.
float hyab(glm::vec3 a, glm::vec3 b) {
    const glm::vec3 d = a - b;
    return std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

/// A product filter; taps -radius..radius.
struct Kernel {
    Values x;
    Values y;
    float weight = 1;
};

Values gaussianTaps(int radius, double variance) {
    Values taps;
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) sum += std::exp(-i * i / (2 * variance));
    for (int i = -radius; i <= radius; ++i) taps.push_back(float(std::exp(-i * i / (2 * variance)) / sum));
    return taps;
}

// Scales the positive taps to sum 1 and the negative ones to sum -1.
void normalizeSigned(Values& taps) {
    double positive = 0, negative = 0;
    for (const float tap : taps) (tap > 0 ? positive : negative) += tap;
    for (float& tap : taps) tap = float(tap > 0 ? tap / positive : -tap / negative);
}

// Adds `kernel` over `in`, the edge pixels repeated outwards, to `out`.
void accumulate(const Values& in, int width, int height, const Kernel& kernel, Values& out) {
    const int radius = int(kernel.x.size() / 2);
    Values rows(in.size());
    tbb::parallel_for(0, height, [&](int y) {
        Values padded(size_t(width + 2 * radius));
        const float* row = &in[size_t(y) * width];
        for (int x = 0; x < width + 2 * radius; ++x) padded[x] = row[std::clamp(x - radius, 0, width - 1)];
        float* target = &rows[size_t(y) * width];
        for (int tap = 0; tap <= 2 * radius; ++tap)
            for (int x = 0; x < width; ++x) target[x] += kernel.x[tap] * padded[x + tap];
    });
    tbb::parallel_for(0, height, [&](int y) {
        float* target = &out[size_t(y) * width];
        for (int tap = 0; tap <= 2 * radius; ++tap) {
            const float* row = &rows[size_t(std::clamp(y + tap - radius, 0, height - 1)) * width];
            const float weight = kernel.weight * kernel.y[tap];
            for (int x = 0; x < width; ++x) target[x] += weight * row[x];
        }
    });
}

Values filter(const Values& in, int width, int height, const std::vector<Kernel>& kernels) {
    Values out(in.size());
    for (const Kernel& kernel : kernels) accumulate(in, width, height, kernel, out);
    return out;
}

/// One term of a contrast sensitivity function: a sqrt(pi/b) exp(-pi^2 d^2 / b), d in degrees.
struct SensitivityTerm {
    double a;
    double b;
};
using Sensitivity = std::vector<SensitivityTerm>;

// The fits to achromatic, red-green and blue-yellow sensitivity, in the order of Y, Cx, Cz.
const std::array<Sensitivity, 3>& sensitivities() {
    static const std::array<Sensitivity, 3> kFits{
        {{{1.0, 0.0047}}, {{1.0, 0.0053}}, {{34.1, 0.04}, {13.5, 0.025}}}};
    return kFits;
}

std::vector<Kernel> sensitivityKernels(const Sensitivity& sensitivity, float pixelsPerDegree) {
    constexpr double kLargestB = 0.04;  // of all channels: they share one support
    const double pi = kPi, degrees = 1.0 / pixelsPerDegree;
    const int radius = int(std::ceil(3 * std::sqrt(kLargestB / (2 * pi * pi)) * pixelsPerDegree));
    std::vector<Kernel> kernels;
    double total = 0;
    for (const auto& [a, b] : sensitivity) {
        const double variance = b / (2 * pi * pi * degrees * degrees);  // in pixels squared
        double sum = 0;
        for (int i = -radius; i <= radius; ++i) sum += std::exp(-i * i / (2 * variance));
        const double mass = a * std::sqrt(pi / b) * sum * sum;
        const Values taps = gaussianTaps(radius, variance);
        kernels.push_back({taps, taps, float(mass)});
        total += mass;
    }
    for (Kernel& kernel : kernels) kernel.weight = float(kernel.weight / total);
    return kernels;
}

struct Channels {
    std::array<Values, 3> ycxcz;
};

Channels toYcxcz(const Image& image) {
    Channels out;
    for (Values& values : out.ycxcz) values.resize(image.pixels.size());
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        const glm::vec3 color = ycxczFromRgb(glm::clamp(image.pixels[i], 0.0f, 1.0f));
        for (int c = 0; c < 3; ++c) out.ycxcz[c][i] = color[c];
    }
    return out;
}

// The colours of an image as filtered by the eye's contrast sensitivity at this distance.
std::vector<glm::vec3> perceivedColors(const Channels& channels, int width, int height,
                                       float pixelsPerDegree) {
    std::array<Values, 3> seen;
    for (int c = 0; c < 3; ++c)
        seen[c] =
            filter(channels.ycxcz[c], width, height, sensitivityKernels(sensitivities()[c], pixelsPerDegree));
    const glm::mat3 rgbFromXyz = glm::inverse(kXyzFromRgb);
    std::vector<glm::vec3> colors(seen[0].size());
    tbb::parallel_for(size_t(0), colors.size(), [&](size_t i) {
        const glm::vec3 xyz = xyzRelativeFromYcxcz({seen[0][i], seen[1][i], seen[2][i]}) * kWhiteXyz;
        colors[i] = huntLabFromRgb(glm::clamp(rgbFromXyz * xyz, 0.0f, 1.0f));
    });
    return colors;
}

// Strength of edges and of points (lines, dots) in the achromatic channel.
struct Features {
    Values edge;
    Values point;
};

Features findFeatures(const Channels& channels, int width, int height, float pixelsPerDegree) {
    const double deviation = 0.5 * kFeatureWidthDegrees * pixelsPerDegree;
    const int radius = int(std::ceil(3 * deviation));
    const Values smooth = gaussianTaps(radius, deviation * deviation);
    Values first = smooth, second = smooth;
    for (int i = -radius; i <= radius; ++i) {
        first[i + radius] *= float(-i);
        second[i + radius] *= float(i * i / (deviation * deviation) - 1);
    }
    normalizeSigned(first);
    normalizeSigned(second);

    Values luminance = channels.ycxcz[0];
    for (float& value : luminance) value = (value + 16) / 116;
    const auto magnitude = [&](const Values& taps) {
        Values across = filter(luminance, width, height, {{taps, smooth}});
        const Values down = filter(luminance, width, height, {{smooth, taps}});
        for (size_t i = 0; i < across.size(); ++i) across[i] = std::hypot(across[i], down[i]);
        return across;
    };
    return {magnitude(first), magnitude(second)};
}

// HyAB^q_c to [0,1]: the interesting part is stretched, what is very different anyway compressed.
float colorError(float difference, float largest) {
    const float knee = kColorKnee * largest;
    if (difference < knee) return kColorAtKnee / knee * difference;
    return std::min(1.0f, kColorAtKnee + (difference - knee) / (largest - knee) * (1 - kColorAtKnee));
}

}  // namespace

std::vector<float> flipMap(const Image& test, const Image& reference, float pixelsPerDegree) {
    assert(test.width == reference.width && test.height == reference.height);
    assert(pixelsPerDegree >= 8);
    if (reference.pixels.empty()) return {};
    const int width = reference.width, height = reference.height;
    const Channels testChannels = toYcxcz(test), referenceChannels = toYcxcz(reference);
    const auto testColors = perceivedColors(testChannels, width, height, pixelsPerDegree);
    const auto referenceColors = perceivedColors(referenceChannels, width, height, pixelsPerDegree);
    const Features testFeatures = findFeatures(testChannels, width, height, pixelsPerDegree);
    const Features referenceFeatures = findFeatures(referenceChannels, width, height, pixelsPerDegree);

    // The farthest that two displayable colours are apart: green and blue.
    const float largest =
        std::pow(hyab(huntLabFromRgb({0, 1, 0}), huntLabFromRgb({0, 0, 1})), kColorExponent);
    std::vector<float> errors(reference.pixels.size());
    tbb::parallel_for(size_t(0), errors.size(), [&](size_t i) {
        const float color =
            colorError(std::pow(hyab(testColors[i], referenceColors[i]), kColorExponent), largest);
        const float feature = std::max(std::abs(testFeatures.edge[i] - referenceFeatures.edge[i]),
                                       std::abs(testFeatures.point[i] - referenceFeatures.point[i]));
        const float featureError = std::pow(std::min(1.0f, feature * std::sqrt(0.5f)), kFeatureExponent);
        errors[i] = std::pow(color, 1 - featureError);
    });
    return errors;
}

}  // namespace phat
