#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "core/base/point_tree.h"
#include "core/transport/photon_map.h"

namespace phat {
namespace {

// Fastest of 8, 10, 16, 32 for k = 50 (bench/photon_bench.cpp).
constexpr size_t kLeafSize = 32;

// The tree drops what is not strictly nearer than the worst distance. One step beyond it keeps equals in, for
// the result sets to decide by photon order.
float justBeyond(float distanceSquared) {
    return std::nextafter(distanceSquared, std::numeric_limits<float>::infinity());
}

// Lower bounds of whole branches are sums with rounding errors: look a little farther than they say.
const nanoflann::SearchParams kSearch(32, -1e-5f);

bool before(const PhotonIndex::Neighbor& a, const PhotonIndex::Neighbor& b) {
    return a.distanceSquared != b.distanceSquared ? a.distanceSquared < b.distanceSquared
                                                  : a.photon < b.photon;
}

// A heap of the k best, the worst on top.
struct NearestSet {
    size_t k;
    float maxDistanceSquared;
    const std::function<bool(uint32_t)>* accept;  // null: all
    std::vector<PhotonIndex::Neighbor>& heap;

    size_t size() const { return heap.size(); }
    bool full() const { return heap.size() == k; }
    float worstDist() const { return justBeyond(full() ? heap.front().distanceSquared : maxDistanceSquared); }
    bool addPoint(float distanceSquared, uint32_t photon) {
        const PhotonIndex::Neighbor found{photon, distanceSquared};
        if (full() && !before(found, heap.front())) return true;
        if (accept && !(*accept)(photon)) return true;
        if (full()) {
            std::pop_heap(heap.begin(), heap.end(), before);
            heap.back() = found;
        } else {
            heap.push_back(found);
        }
        std::push_heap(heap.begin(), heap.end(), before);
        return true;
    }
};

struct WithinSet {
    float maxDistanceSquared;
    std::vector<PhotonIndex::Neighbor>& found;

    size_t size() const { return found.size(); }
    bool full() const { return true; }
    float worstDist() const { return justBeyond(maxDistanceSquared); }
    bool addPoint(float distanceSquared, uint32_t photon) {
        found.push_back({photon, distanceSquared});
        return true;
    }
};

// In photon order. A radix sort by this many bits at a time; few are sorted by comparisons.
void sortByPhoton(std::vector<PhotonIndex::Neighbor>& found) {
    constexpr uint32_t kBits = 11, kBuckets = 1u << kBits;
    constexpr size_t kFew = 256;
    const auto byPhoton = [](const PhotonIndex::Neighbor& a, const PhotonIndex::Neighbor& b) {
        return a.photon < b.photon;
    };
    if (found.size() < kFew) {
        std::sort(found.begin(), found.end(), byPhoton);
        return;
    }
    const uint32_t last = std::max_element(found.begin(), found.end(), byPhoton)->photon;
    std::vector<PhotonIndex::Neighbor> sorted(found.size());
    for (uint32_t shift = 0; shift < 32 && (last >> shift) != 0; shift += kBits) {
        std::array<uint32_t, kBuckets> place{};
        for (const PhotonIndex::Neighbor& each : found) ++place[(each.photon >> shift) % kBuckets];
        std::exclusive_scan(place.begin(), place.end(), place.begin(), 0u);
        for (const PhotonIndex::Neighbor& each : found)
            sorted[place[(each.photon >> shift) % kBuckets]++] = each;
        found.swap(sorted);
    }
}

}  // namespace

struct PhotonIndex::Tree {
    PointCloud positions;
    PointTree adaptor;

    explicit Tree(PointCloud all)
        : positions(std::move(all)),
          adaptor(3, positions, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize)) {}

    void search(glm::vec3 position, auto&& results) const {
        adaptor.findNeighbors(results, &position.x, kSearch);
    }
};

PhotonIndex::PhotonIndex(std::span<const Photon> photons) {
    if (photons.size() > std::numeric_limits<uint32_t>::max()) throw std::length_error("too many photons");
    PointCloud positions;
    positions.points.reserve(photons.size());
    for (const Photon& photon : photons) positions.points.push_back(photon.position);
    tree_ = std::make_unique<Tree>(std::move(positions));
}

PhotonIndex::~PhotonIndex() = default;
PhotonIndex::PhotonIndex(PhotonIndex&&) noexcept = default;

void PhotonIndex::nearest(glm::vec3 position, uint32_t k, float maxRadiusMeters,
                          std::vector<Neighbor>& out) const {
    out.clear();
    if (k == 0) return;
    tree_->search(position, NearestSet{k, square(maxRadiusMeters), nullptr, out});
    std::sort_heap(out.begin(), out.end(), before);
}

void PhotonIndex::nearest(glm::vec3 position, uint32_t k, float maxRadiusMeters,
                          const std::function<bool(uint32_t)>& accept, std::vector<Neighbor>& out) const {
    out.clear();
    if (k == 0) return;
    tree_->search(position, NearestSet{k, square(maxRadiusMeters), &accept, out});
    std::sort_heap(out.begin(), out.end(), before);
}

void PhotonIndex::within(glm::vec3 position, float radiusMeters, std::vector<Neighbor>& out) const {
    out.clear();
    tree_->search(position, WithinSet{square(radiusMeters), out});
    sortByPhoton(out);
}

}  // namespace phat
