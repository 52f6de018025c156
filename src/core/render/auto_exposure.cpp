#include "core/render/auto_exposure.h"

#include <tbb/parallel_for.h>

#include "core/render/picture.h"
#include "core/scene/shading.h"

namespace phat {
namespace {

// Enough for percentiles, and a tenth of a second of rays.
constexpr int kMaxSide = 256;

// Of the lit pixels, by luminance. Chosen by eye on scenes/ and on rooms of others.
constexpr double kDarkest = 0.1, kBrightest = 0.9;
// The luminance that this part of the pixels stays below is not exposed beyond kBrightestExposed, about where
// AgX begins to look white.
constexpr double kHighlights = 0.95;
constexpr float kBrightestExposed = 2;

// Less light than this part of the brightest is none: pixels that a few paths reached.
constexpr float kBlack = 1e-5f;

std::vector<float> luminancesOf(const Image& picture, std::span<const uint32_t> pixels) {
    std::vector<float> found;
    for (const uint32_t i : pixels)
        if (const float y = luminance(picture.pixels[i]); y > 0 && std::isfinite(y)) found.push_back(y);
    std::sort(found.begin(), found.end());
    return found;
}

float quantile(const std::vector<float>& sorted, double fraction) {
    return sorted[std::min(sorted.size() - 1, size_t(fraction * double(sorted.size())))];
}

}  // namespace

float autoExposureStops(const Image& picture, std::span<const uint32_t> pixels) {
    std::vector<float> lit = luminancesOf(picture, pixels);
    if (lit.empty()) {
        std::vector<uint32_t> all(picture.pixels.size());
        for (size_t i = 0; i < all.size(); ++i) all[i] = uint32_t(i);
        lit = luminancesOf(picture, all);
    }
    if (lit.empty()) return 0;
    const float black = kBlack * quantile(lit, kHighlights);
    lit.erase(lit.begin(), std::lower_bound(lit.begin(), lit.end(), black));

    const size_t first = size_t(kDarkest * double(lit.size())),
                 end = std::max(first + 1, size_t(kBrightest * double(lit.size())));
    double sum = 0;
    for (size_t i = first; i < end; ++i) sum += std::log2(double(lit[i]));
    const double wanted = std::log2(double(kMiddleGrey)) - sum / double(end - first);
    const double most = std::log2(double(kBrightestExposed) / double(quantile(lit, kHighlights)));
    const double stops = std::clamp(std::min(wanted, most), -double(kMaxStops), double(kMaxStops));
    return float(std::round(10 * stops) / 10);
}

std::vector<uint32_t> meteredPixels(const RayScene& rays, const Camera& camera, int width, int height) {
    const int step = (std::max(width, height) + kMaxSide - 1) / kMaxSide;
    const int columns = (width + step - 1) / step, rows = (height + step - 1) / step;
    std::vector<uint8_t> counts(size_t(columns) * size_t(rows));
    tbb::parallel_for(0, rows, [&](int row) {
        for (int column = 0; column < columns; ++column) {
            const Ray ray =
                cameraRay(camera, width, height, {float(column * step) + 0.5f, float(row * step) + 0.5f});
            uint64_t count = 0;
            const Hit hit = visibleHit(rays, ray, count);
            counts[size_t(row) * size_t(columns) + size_t(column)] =
                hit && maxComponent(surfaceAt(rays.scene(), hit, ray.direction).emission) <= 0;
        }
    });
    std::vector<uint32_t> pixels;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
            if (counts[size_t(row) * size_t(columns) + size_t(column)])
                pixels.push_back(uint32_t(row * step) * uint32_t(width) + uint32_t(column * step));
    return pixels;
}

}  // namespace phat
