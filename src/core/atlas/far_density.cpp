#include "core/atlas/far_density.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/atlas/atlas.h"
#include "core/base/median.h"
#include "core/scene/triangle_corners.h"

namespace phat {
namespace {

// Times the median distance of the pieces: no piece of a usual room or street is so far away.
constexpr double kFarReach = 8;
// Points of a large triangle whose distances are averaged, along each of two sides.
constexpr int kPointsPerSide = 16;

glm::dvec3 middleOf(const Scene& scene, const FlatChart& flat) {
    glm::dvec3 low(1e300), high(-1e300);
    for (const uint32_t t : flat.triangles) {
        for (const glm::dvec3& p : cornersOf<glm::dvec3>(scene, t)) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    }
    return 0.5 * (low + high);
}

double farthestOf(const Scene& scene, const FlatChart& flat, const glm::dvec3& from) {
    double distance = 0;
    for (const uint32_t t : flat.triangles)
        for (const glm::dvec3& p : cornersOf<glm::dvec3>(scene, t))
            distance = std::max(distance, glm::distance(p, from));
    return distance;
}

// The mean of (reach / distance)^2, at most 1, over a piece: what its texels may be fewer by.
double nearness(const Scene& scene, const FlatChart& flat, const glm::dvec3& from, double reach) {
    double sum = 0, total = 0;
    for (const uint32_t t : flat.triangles) {
        const auto [a, b, c] = cornersOf<glm::dvec3>(scene, t);
        const double area = glm::length(glm::cross(b - a, c - a));
        const bool large = farthestOf(scene, {{t}, {}, {}, 0, 0}, from) > reach;
        const int side = large ? kPointsPerSide : 1;
        double mean = 0;
        for (int i = 0; i < side * side; ++i) {
            double u = (i % side + 0.5) / side, v = (i / side + 0.5) / side;
            if (u + v > 1) u = 1 - u, v = 1 - v;
            const double distance = glm::distance(a + u * (b - a) + v * (c - a), from);
            mean +=
                std::min(1.0, (reach / std::max(distance, 1e-300)) * (reach / std::max(distance, 1e-300)));
        }
        sum += area * mean / (side * side);
        total += area;
    }
    return total > 0 ? sum / total : 1;
}

}  // namespace

std::vector<double> farDensities(const Scene& scene, std::span<const FlatChart> flats,
                                 std::span<const double> area) {
    std::vector<double> density(flats.size(), 1.0);
    if (flats.size() < 2) return density;
    std::vector<double> axis[3], distances;
    for (const FlatChart& flat : flats) {
        const glm::dvec3 middle = middleOf(scene, flat);
        for (int i = 0; i < 3; ++i) axis[i].push_back(middle[i]);
    }
    const glm::dvec3 center(medianOf(axis[0]), medianOf(axis[1]), medianOf(axis[2]));
    for (const FlatChart& flat : flats) distances.push_back(farthestOf(scene, flat, center));
    const double reach = kFarReach * medianOf(distances);

    double nearArea = 0, farArea = 0;
    for (size_t f = 0; f < flats.size(); ++f) {
        if (distances[f] <= reach) {
            nearArea += area[f];
            continue;
        }
        const double fewer = nearness(scene, flats[f], center, reach);
        density[f] = std::sqrt(fewer);
        farArea += fewer * area[f];
    }
    if (farArea > nearArea && nearArea > 0)
        for (size_t f = 0; f < flats.size(); ++f)
            if (distances[f] > reach) density[f] *= std::sqrt(nearArea / farArea);
    return density;
}

std::vector<double> farDensitiesOfTriangles(const Scene& scene, const MeshTopology& topology) {
    const std::vector<uint32_t> component = connectedComponents(scene);
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> pieceOf;
    std::vector<FlatChart> pieces;
    std::vector<double> areas;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        if (topology.degenerate(t)) continue;
        const auto [piece, isNew] =
            pieceOf.try_emplace({scene.triangleSurface[t], component[t]}, uint32_t(pieces.size()));
        if (isNew) {
            pieces.emplace_back();
            areas.push_back(0);
        }
        pieces[piece->second].triangles.push_back(t);
        areas[piece->second] += topology.faceArea[t];
    }
    const std::vector<double> density = farDensities(scene, pieces, areas);
    std::vector<double> result(scene.triangles.size(), 1.0);
    for (size_t i = 0; i < pieces.size(); ++i)
        for (const uint32_t t : pieces[i].triangles) result[t] = density[i];
    return result;
}

}  // namespace phat
