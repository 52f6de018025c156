#include "core/atlas/atlas_pack.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "core/atlas/skyline.h"
#include "core/base/random.h"

namespace phat {
namespace {

// A chart at some texel size.
struct Fit {
    glm::uvec2 tiles{1};  // gutters included
    double scale = 1;     // its texels along a length, over those asked for
    GroupLayout layout;   // of several pieces
};

Fit fitOf(glm::dvec2 sizeTexels, double scale, uint32_t gutter) {
    // A box that is a whole number of tiles but for rounding must not take another tile.
    constexpr double kSlackTexels = 1e-4;
    const glm::dvec2 texels = scale * sizeTexels + 2.0 * gutter - kSlackTexels;
    return {glm::uvec2(glm::max(glm::ceil(texels / double(kTileSize)), 1.0)), scale, {}};
}

// The fit within `freedom` of the asked density whose tiles the chart fills best: one side then ends where a
// tile does. Charts of some ten tiles lose a twentieth of their area to rounding without it.
Fit bestFitOf(glm::dvec2 sizeTexels, uint32_t gutter, double freedom) {
    Fit best = fitOf(sizeTexels, 1, gutter);
    const auto filled = [&](const Fit& fit) {
        return fit.scale * fit.scale / (double(fit.tiles.x) * double(fit.tiles.y));
    };
    for (int axis = 0; axis < 2; ++axis) {
        const auto tilesAt = [&](double scale) {
            return (scale * sizeTexels[axis] + 2.0 * gutter) / double(kTileSize);
        };
        const double last = std::floor(tilesAt(freedom));
        for (double tiles = std::ceil(tilesAt(1 / freedom)); tiles <= last; ++tiles) {
            const double scale = (tiles * kTileSize - 2.0 * gutter) / sizeTexels[axis];
            if (!(scale > 0)) continue;
            const Fit fit = fitOf(sizeTexels, scale, gutter);
            if (filled(fit) > filled(best)) best = fit;
        }
    }
    return best;
}

std::vector<glm::dvec2> pieceTexels(const PackBox& box, double texelSizeMeters) {
    std::vector<glm::dvec2> sizes;
    for (const glm::dvec2& size : box.pieces) sizes.push_back(size / texelSizeMeters);
    return sizes;
}

std::vector<Fit> fitsOf(std::span<const PackBox> boxes, double texelSizeMeters, uint32_t gutter,
                        double freedom) {
    std::vector<Fit> fits(boxes.size());
    tbb::parallel_for(size_t(0), boxes.size(), [&](size_t i) {
        if (boxes[i].pieces.empty()) {
            fits[i] = bestFitOf(boxes[i].sizeMeters / texelSizeMeters, gutter, freedom);
        } else {
            fits[i].layout =
                layOutGroup(pieceTexels(boxes[i], texelSizeMeters), freedom > 1 ? kPieceFreedom : 1.0);
            fits[i].tiles = fits[i].layout.sizeTiles;
        }
    });
    return fits;
}

double sumOf(const std::vector<Fit>& fits) {
    double sum = 0;
    for (const Fit& fit : fits) sum += double(fit.tiles.x) * double(fit.tiles.y);
    return sum;
}

// About the sum over fitsOf.
double tilesAt(std::span<const PackBox> boxes, double texelSizeMeters, uint32_t gutter) {
    double sum = 0;
    for (const PackBox& box : boxes) {
        if (box.pieces.empty()) {
            const Fit fit = bestFitOf(box.sizeMeters / texelSizeMeters, gutter, kFillFreedom);
            sum += double(fit.tiles.x) * double(fit.tiles.y);
        } else {
            sum += estimateGroupTiles(pieceTexels(box, texelSizeMeters));
        }
    }
    return sum;
}

// One run of the skyline packer; empty sizeTiles if the boxes do not fit.
Packing packAtWidth(const std::vector<Fit>& fits, const std::vector<uint8_t>& turned, uint32_t width,
                    uint32_t maxHeight, Skyline heuristic) {
    Packing packing;
    for (size_t i = 0; i < fits.size(); ++i)
        packing.chartTiles.push_back(turned[i] ? glm::uvec2(fits[i].tiles.y, fits[i].tiles.x)
                                               : fits[i].tiles);
    auto packed = packSkyline(packing.chartTiles, {width, maxHeight}, heuristic);
    if (!packed) return {};
    packing.turned = turned;
    packing.originTile = std::move(packed->origin);
    packing.sizeTiles = packed->size;
    return packing;
}

// The smallest atlas over widths, heuristics and ways to lay the charts. `effort`: box placements to spend.
Packing packTiles(std::span<const PackBox> boxes, const std::vector<Fit>& fits, uint32_t maxTiles,
                  uint64_t effort, const Progress& progress) {
    uint32_t narrowest = 1;
    for (const Fit& fit : fits) narrowest = std::max(narrowest, std::min(fit.tiles.x, fit.tiles.y));
    const double side = std::sqrt(sumOf(fits));
    const uint64_t runs = std::clamp<uint64_t>(effort / std::max<size_t>(fits.size(), 1), 4, 400);

    Packing best;
    uint64_t bestArea = std::numeric_limits<uint64_t>::max();
    std::vector<uint8_t> turned(fits.size());
    for (uint64_t run = 0; run < runs; ++run) {
        progress.throwIfStopped();
        // Aspect ratios of about 1 to 2, upright and lying boxes alternating, then mixed ones.
        const double aspect = 1.0 + double(run / 4) / double((runs + 3) / 4);
        const Skyline heuristic = run & 1 ? Skyline::bestFit : Skyline::bottomLeft;
        const bool upright = (run & 2) != 0;
        const uint32_t width =
            uint32_t(std::clamp(std::ceil(side * std::sqrt(aspect)), double(narrowest), double(maxTiles)));
        for (size_t i = 0; i < fits.size(); ++i) {
            const uint32_t longer = std::max(fits[i].tiles.x, fits[i].tiles.y);
            bool stands = upright || longer > width;
            // Every second round lays about a third of the boxes the other way, if they fit.
            if ((run & 4) && hashOf(run, i) % 3 == 0 && longer <= width) stands = !stands;
            turned[i] = stands != (fits[i].tiles.y > fits[i].tiles.x);
            if (boxes[i].twin) turned[i] = turned[i - 1];
        }
        Packing packing = packAtWidth(fits, turned, width, maxTiles, heuristic);
        const uint64_t area = uint64_t(packing.sizeTiles.x) * packing.sizeTiles.y;
        if (area == 0 || area >= bestArea) continue;
        bestArea = area;
        best = std::move(packing);
    }
    if (!best.originTile.empty())
        for (const Fit& fit : fits) {
            best.scale.push_back(fit.scale);
            best.layout.push_back(fit.layout);
        }
    return best;
}

[[noreturn]] void throwTooLarge(const AtlasSettings& settings) {
    throw std::runtime_error("the atlas does not fit in " + std::to_string(settings.maxSizeTexels) + "x" +
                             std::to_string(settings.maxSizeTexels) + " texels; ask for larger texels");
}

// About a second for any number of charts.
constexpr uint64_t kEffort = 200000;

uint32_t maxTilesOf(const AtlasSettings& settings) {
    return std::max(1u, settings.maxSizeTexels / kTileSize);
}

Packing packAtTexelSize(std::span<const PackBox> boxes, const AtlasSettings& settings, Progress& progress) {
    const uint32_t maxTiles = maxTilesOf(settings);
    const auto fits = fitsOf(boxes, settings.texelSizeMeters, settings.gutterTexels, 1);
    Packing packing;
    if (std::all_of(fits.begin(), fits.end(),
                    [&](const Fit& fit) { return std::max(fit.tiles.x, fit.tiles.y) <= maxTiles; }))
        packing = packTiles(boxes, fits, maxTiles, kEffort, progress);
    if (packing.originTile.empty()) throwTooLarge(settings);
    packing.texelSizeMeters = settings.texelSizeMeters;
    return packing;
}

/// Texel sizes between which the atlas of a budget lies.
struct TexelSizes {
    double finest;    // no gutters, no gaps
    double coarsest;  // coarser ones save nothing
};

TexelSizes texelSizesFor(std::span<const PackBox> boxes, const AtlasSettings& settings, double budget) {
    double area = 0, longest = 0;
    const auto add = [&](glm::dvec2 size) {
        area += size.x * size.y;
        longest = std::max({longest, size.x, size.y});
    };
    for (const PackBox& box : boxes) {
        if (box.pieces.empty()) add(box.sizeMeters);
        for (const glm::dvec2& piece : box.pieces) add(piece);
    }
    const double roomTexels = double(maxTilesOf(settings)) * kTileSize - 2.0 * settings.gutterTexels;
    const double finest = std::max(std::sqrt(area / budget), longest / std::max(roomTexels, 1.0));
    return {finest, 32 * finest};
}

}  // namespace

Packing packCharts(std::span<const PackBox> boxes, const AtlasSettings& settings, Progress& progress) {
    if (boxes.empty()) return {};
    if (settings.texelSizeMeters > 0) return packAtTexelSize(boxes, settings, progress);

    const uint32_t maxTiles = maxTilesOf(settings);
    const double budget = double(std::max<uint64_t>(settings.texelBudget, kTileSize * kTileSize));
    const auto [finest, coarsest] = texelSizesFor(boxes, settings, budget);

    // Bisection of the logarithm, first on the boxes' sum (cheap) with the fraction of the atlas that the
    // last packing could fill, then packed. The fraction hardly depends on the texel size: two or three
    // packings do.
    constexpr double kTolerance = 0.02;
    double filled = 0.85;
    // Many small charts: their gutters alone may exceed the budget, and coarser texels then save nothing. A
    // quarter over the tiles that must be there anyway, the triangles keep what these tiles have room for.
    const double leastTexels = tilesAt(boxes, coarsest, settings.gutterTexels) * kTileSize * kTileSize;
    const double target = std::max(budget, 1.25 * leastTexels);
    Packing best;
    bool bestWithin = false;
    for (int round = 0; round < 6; ++round) {
        double fine = finest, coarse = coarsest;
        for (int step = 0; step < 40; ++step) {
            const double middle = std::sqrt(fine * coarse);
            const double texels = tilesAt(boxes, middle, settings.gutterTexels) * kTileSize * kTileSize;
            const bool within = texels <= std::max(filled * target, 1.02 * leastTexels);
            (within ? coarse : fine) = middle;
        }
        const auto fits = fitsOf(boxes, coarse, settings.gutterTexels, kFillFreedom);
        Packing packing = packTiles(boxes, fits, maxTiles, kEffort, progress);
        packing.texelSizeMeters = coarse;
        const double packed = double(packing.sizeTiles.x) * packing.sizeTiles.y * kTileSize * kTileSize;
        if (packed == 0) {  // higher or wider than maxSizeTexels
            filled *= 0.8;
            continue;
        }
        filled = tilesAt(boxes, coarse, settings.gutterTexels) * kTileSize * kTileSize / packed;
        const bool within = packed <= target;
        const bool better = within == bestWithin ? coarse < best.texelSizeMeters : within;
        if (best.originTile.empty() || better) {
            best = std::move(packing);
            bestWithin = within;
        }
        if (within && packed >= (1 - kTolerance) * target) break;
        if (!within) filled *= 0.995;  // approach the target from below
    }
    if (best.originTile.empty()) throwTooLarge(settings);
    return best;
}

namespace {

// How a box is laid where it comes to lie nearest to the first row; a twin will have a place like it.
bool liesBetterTurned(FreeTiles& tiles, glm::uvec2 size, uint32_t width) {
    const glm::uvec2 other(size.y, size.x);
    if (size.x > width || other.x > width) return size.x > width;
    return tiles.find(other).y + other.y < tiles.find(size).y + size.y;
}

}  // namespace

Packing packChartsAround(std::span<const PackBox> boxes, const AtlasSettings& settings,
                         double texelSizeMeters, const TakenTiles& taken) {
    const bool given = settings.texelSizeMeters > 0;
    const auto fits = fitsOf(boxes, texelSizeMeters, settings.gutterTexels, given ? 1 : kFillFreedom);
    Packing packing;
    packing.texelSizeMeters = texelSizeMeters;
    uint32_t width = taken.width;
    std::vector<size_t> order;
    for (size_t i = 0; i < fits.size(); ++i) {
        packing.chartTiles.push_back(fits[i].tiles);
        packing.scale.push_back(fits[i].scale);
        packing.layout.push_back(fits[i].layout);
        width = std::max(width, std::min(fits[i].tiles.x, fits[i].tiles.y));
        if (!boxes[i].twin) order.push_back(i);
    }
    packing.originTile.resize(fits.size());
    packing.turned.resize(fits.size(), 0);
    if (width > maxTilesOf(settings)) throwTooLarge(settings);
    // The longest first: the small ones find gaps.
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        return std::max(fits[a].tiles.x, fits[a].tiles.y) > std::max(fits[b].tiles.x, fits[b].tiles.y);
    });
    FreeTiles tiles(width, taken);
    packing.sizeTiles = {width, 0};
    for (const auto& [origin, size] : taken.rectangles)
        packing.sizeTiles.y = std::max(packing.sizeTiles.y, origin.y + size.y);
    for (const size_t first : order) {
        const bool turned = liesBetterTurned(tiles, fits[first].tiles, width);
        for (size_t i = first; i == first || (i < boxes.size() && boxes[i].twin); ++i) {
            glm::uvec2& size = packing.chartTiles[i];
            if (turned) size = {size.y, size.x};
            packing.turned[i] = turned;
            packing.originTile[i] = tiles.find(size);
            tiles.take(packing.originTile[i], size);
            packing.sizeTiles.y = std::max(packing.sizeTiles.y, packing.originTile[i].y + size.y);
            if (packing.sizeTiles.y > maxTilesOf(settings)) throwTooLarge(settings);
        }
    }
    return packing;
}

}  // namespace phat
