#include "core/atlas/piece_group.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/atlas/atlas.h"
#include "core/atlas/skyline.h"

namespace phat {
namespace {

// A piece stays alone while its own tiles take no more than this times the texels of its place among others.
constexpr double kMaxOwnTexels = 1.1;
// Texels of a group at most: eight blocks. Larger ones fill their tiles little better.
constexpr double kGroupTexels = 8192;
// How far from the first piece's middle others may lie, in texels of the group: the width of two blocks. What
// is stored for blocks and tiles counts as seen from one place.
constexpr double kGroupReachTexels = 64;
// What is left over is too small to fill its tiles; it looks so many times farther.
constexpr double kSmallGroupTexels = 1024;
constexpr double kWideReachTexels = 128;
// All triangles' normals of others are within this angle of the first piece's mean normal, those of the first
// within about 40 degrees: any two are in one hemisphere.
constexpr double kGroupConeDegrees = 44;
// Share of a group's texels that the skyline packer leaves to its pieces; measured on tools/make_house.py.
constexpr double kUsualFill = 0.9;

/// Pieces of one kind in a uniform grid, whose cells are as large as a group reaches.
class PieceGrid {
  public:
    explicit PieceGrid(double cellMeters) : cellMeters_(cellMeters) {}
    void add(uint32_t piece, const glm::dvec3& center) { cells_[cellOf(center)].push_back(piece); }
    template <typename Visit>
    void forNear(const glm::dvec3& center, const Visit& visit) const {
        const auto [x, y, z] = cellOf(center);
        for (int64_t i = 0; i < 27; ++i) {
            const auto found = cells_.find({x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1});
            if (found == cells_.end()) continue;
            for (const uint32_t piece : found->second) visit(piece);
        }
    }

  private:
    using Cell = std::tuple<int64_t, int64_t, int64_t>;
    Cell cellOf(const glm::dvec3& p) const {
        const glm::dvec3 cell = glm::clamp(glm::floor(p / cellMeters_), -1e15, 1e15);
        return {int64_t(cell.x), int64_t(cell.y), int64_t(cell.z)};
    }
    double cellMeters_;
    std::map<Cell, std::vector<uint32_t>> cells_;
};

/// Pieces that will share a chart; the first one's pose stands for all.
struct Cluster {
    std::vector<uint32_t> pieces;
    double texels = 0;      // of their places
    glm::uvec2 longest{0};  // sides of these, as the first piece lies
};

/// About the texels of a cluster's chart in whole tiles: it is as wide and as high as the longest pieces.
double chartTexels(const Cluster& cluster) {
    const auto whole = [](double texels) { return std::ceil(texels / kTileSize) * kTileSize; };
    const double needed = cluster.texels / kUsualFill, narrowest = whole(cluster.longest.x);
    double least = 1e300;
    for (const double width : {narrowest, std::max(narrowest, whole(std::sqrt(needed)))})
        least = std::min(least, width * whole(std::max(double(cluster.longest.y), needed / width)));
    return least;
}

class Clusterer {
  public:
    Clusterer(std::span<const PieceClass> classes, const std::vector<PiecePose>& poses,
              const Progress& progress)
        : classes_(classes), poses_(poses), progress_(progress) {}

    /// Joins clusters of fewer than `most` texels with those whose first pieces are within `reachTexels`,
    /// nearest first. Ordered by first piece.
    std::vector<Cluster> joinNear(std::vector<Cluster> clusters, double reachTexels, double most) const {
        const auto poseOfCluster = [&](uint32_t c) -> const PiecePose& {
            return poses_[clusters[c].pieces[0]];
        };
        const auto reachOf = [&](uint32_t c) {
            return reachTexels * classes_[clusters[c].pieces[0]].texelSizeMeters;
        };
        const auto facesAs = [&](const Cluster& cluster, const glm::dvec3& normal) {
            return std::all_of(cluster.pieces.begin(), cluster.pieces.end(), [&](uint32_t piece) {
                const double angle = std::acos(std::min(glm::dot(poses_[piece].normal, normal), 1.0));
                return angle + poses_[piece].lean <= glm::radians(kGroupConeDegrees);
            });
        };
        std::map<uint32_t, PieceGrid> grids;
        for (uint32_t c = 0; c < clusters.size(); ++c)
            if (clusters[c].texels < most)
                grids.try_emplace(classes_[clusters[c].pieces[0]].kind, reachOf(c))
                    .first->second.add(c, poseOfCluster(c).center);
        std::vector<Cluster> joined;
        std::vector<uint8_t> taken(clusters.size(), 0);
        for (uint32_t c = 0; c < clusters.size(); ++c) {
            if (taken[c]) continue;
            taken[c] = 1;
            joined.push_back(clusters[c]);
            if (!(clusters[c].texels < most)) continue;
            progress_.throwIfStopped();
            std::vector<std::pair<double, uint32_t>> others;
            grids.at(classes_[clusters[c].pieces[0]].kind).forNear(poseOfCluster(c).center, [&](uint32_t o) {
                const double distance = glm::distance(poseOfCluster(o).center, poseOfCluster(c).center);
                if (!taken[o] && distance <= reachOf(c) && facesAs(clusters[o], poseOfCluster(c).normal))
                    others.emplace_back(distance, o);
            });
            std::sort(others.begin(), others.end());
            Cluster& own = joined.back();
            for (const auto& [distance, o] : others)
                if (takes(own, clusters[o])) taken[o] = 1;
        }
        return joined;
    }

  private:
    /// Adds the pieces of another cluster, if that takes no more texels than two charts.
    bool takes(Cluster& own, const Cluster& other) const {
        const uint32_t turns = poses_[other.pieces[0]].turnToward(poses_[own.pieces[0]].tangent);
        const glm::uvec2 longest =
            turns % 2 == 0 ? other.longest : glm::uvec2(other.longest.y, other.longest.x);
        Cluster both{own.pieces, own.texels + other.texels, glm::max(own.longest, longest)};
        if (both.texels > kGroupTexels || chartTexels(both) > chartTexels(own) + chartTexels(other))
            return false;
        both.pieces.insert(both.pieces.end(), other.pieces.begin(), other.pieces.end());
        own = std::move(both);
        return true;
    }

    std::span<const PieceClass> classes_;
    const std::vector<PiecePose>& poses_;
    const Progress& progress_;
};

}  // namespace

std::vector<PieceGroup> groupPieces(const Scene& scene, const MeshTopology& topology,
                                    std::span<const FlatChart> flats, std::span<const PieceClass> classes,
                                    uint32_t gutterTexels, const Progress& progress) {
    std::vector<PiecePose> poses(flats.size());
    std::vector<Cluster> single, small;
    for (uint32_t f = 0; f < flats.size(); ++f) {
        const glm::dvec2 size = flats[f].sizeMeters / classes[f].texelSizeMeters;
        const glm::uvec2 place = placeOf(size, kPieceFreedom);
        const double texels = texelsOf(place);
        const bool fills = isLargePiece(size) || texelsAlone(size, gutterTexels) <= kMaxOwnTexels * texels;
        (fills ? single : small).push_back({{f}, texels, place});
        if (!fills) poses[f] = poseOf(scene, topology, flats[f]);
    }
    const Clusterer clusterer{classes, poses, progress};
    small = clusterer.joinNear(std::move(small), kGroupReachTexels, kGroupTexels);
    small = clusterer.joinNear(std::move(small), kWideReachTexels, kSmallGroupTexels);

    std::vector<PieceGroup> groups;
    for (const std::vector<Cluster>* list : {&single, &small})
        for (const Cluster& cluster : *list) {
            PieceGroup group{{cluster.pieces[0], 0}};
            for (size_t i = 1; i < cluster.pieces.size(); ++i) {
                const uint32_t piece = cluster.pieces[i];
                group.push_back({piece, poses[piece].turnToward(poses[cluster.pieces[0]].tangent)});
            }
            groups.push_back(std::move(group));
        }
    std::sort(groups.begin(), groups.end(),
              [](const PieceGroup& a, const PieceGroup& b) { return a[0].flat < b[0].flat; });
    return groups;
}

std::vector<PieceGroup> alone(size_t pieceCount) {
    std::vector<PieceGroup> groups;
    for (uint32_t f = 0; f < pieceCount; ++f) groups.push_back({{f, 0}});
    return groups;
}

double estimateGroupTiles(std::span<const glm::dvec2> sizesTexels) {
    double texels = 0;
    for (const glm::dvec2& size : sizesTexels) texels += texelsOf(placeOf(size, kPieceFreedom));
    return std::ceil(texels / (kUsualFill * kTileSize * kTileSize));
}

GroupLayout layOutGroup(std::span<const glm::dvec2> sizesTexels, double freedom) {
    GroupLayout layout;
    double texels = 0;
    glm::uvec2 largest(0);
    for (const glm::dvec2& size : sizesTexels) {
        layout.size.push_back(placeOf(size, freedom));
        layout.drawn.push_back(drawnSize(size, layout.size.back(), freedom));
        texels += texelsOf(layout.size.back());
        largest = glm::max(largest, layout.size.back());
    }
    const auto tilesFor = [](double texelsWide) { return uint32_t(std::ceil(texelsWide / kTileSize)); };
    // Widths from half to twice the side of a square, or narrower beside a high piece.
    const double narrow = std::min(0.5 * std::sqrt(texels), texels / double(largest.y));
    const uint32_t narrowest = tilesFor(std::max(narrow, double(largest.x)));
    const uint32_t widest = std::max(narrowest, tilesFor(2 * std::sqrt(texels)));
    const uint32_t step = std::max(1u, (widest - narrowest) / 12);
    uint64_t best = ~0ull;
    for (uint32_t width = narrowest; width <= widest; width += step) {
        // Everything on one another would be the highest.
        uint64_t highest = 0;
        for (const glm::uvec2& size : layout.size) highest += size.y;
        const auto packing =
            packSkyline(layout.size, {width * kTileSize, uint32_t(std::min<uint64_t>(highest, 1u << 20))},
                        Skyline::bestFit);
        if (!packing) continue;
        const glm::uvec2 tiles = (packing->size + kTileSize - 1u) / kTileSize;
        if (uint64_t(tiles.x) * tiles.y >= best) continue;
        best = uint64_t(tiles.x) * tiles.y;
        layout.sizeTiles = tiles;
        layout.origin = packing->origin;
    }
    return layout;
}

}  // namespace phat
