#include "core/atlas/wall_regions.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "core/atlas/area_points.h"
#include "core/atlas/texel_cover.h"
#include "core/base/disjoint_sets.h"

namespace phat {
namespace {

constexpr double kMinAreaTexels = 0.25;
// Pieces of a surface that lie in one plane are joined across joints of a texel (join_coplanar.h), and texels
// may become larger than was expected.
constexpr double kApartTexels = 4, kSamePlaneCosine = 0.99;
// Points of a region that are looked at, and how closed they are on average if nobody sees it: under a wall
// that ends a little above a floor light comes in from the sides.
constexpr int kPoints = 32;
constexpr double kMinCover = 0.75;

// Two triangles of a surface side by side.
struct Contact {
    uint32_t a, b;
    const std::vector<uint32_t>* sections;  // of the walls between them; null: none
};

class RegionFinder {
  public:
    RegionFinder(const MeshCutter& cutter, const RayScene& rays, const MeshTopology& topology,
                 double texelSizeMeters)
        : cutter_(cutter),
          rays_(rays),
          topology_(topology),
          texelSize_(texelSizeMeters),
          sets_(cutter.triangles().size()) {}

    WallRegions find(size_t sectionCount) {
        findContacts();
        for (const Contact& contact : contacts_)
            if (!contact.sections) sets_.unite(contact.a, contact.b);
        uniteMinorRegions();
        return result(sectionCount);
    }

  private:
    glm::dvec3 normal(uint32_t triangle) const { return topology_.faceNormal[cutter_.origin(triangle)]; }

    std::array<glm::dvec3, 3> corners(uint32_t triangle) const {
        const glm::uvec3& v = cutter_.triangles()[triangle];
        return {cutter_.position(v[0]), cutter_.position(v[1]), cutter_.position(v[2])};
    }

    double area(uint32_t triangle) const {
        const auto [a, b, c] = corners(triangle);
        return 0.5 * glm::length(glm::cross(b - a, c - a));
    }

    // Ordered by triangles, whatever the order of the edges.
    void findContacts() {
        for (const auto& [edge, users] : cutter_.edges()) {
            const std::vector<uint32_t>* sections = cutter_.sectionsOf(edge);
            for (size_t i = 0; i < users.size(); ++i)
                for (size_t j = i + 1; j < users.size(); ++j) addContact(users[i], users[j], sections);
        }
        std::sort(contacts_.begin(), contacts_.end(),
                  [](const Contact& x, const Contact& y) { return std::tie(x.a, x.b) < std::tie(y.a, y.b); });
    }

    void addContact(uint32_t a, uint32_t b, const std::vector<uint32_t>* sections) {
        const std::vector<uint32_t>& surface = rays_.scene().triangleSurface;
        if (surface[cutter_.origin(a)] != surface[cutter_.origin(b)]) return;
        if (isFold(normal(a), normal(b))) return;
        contacts_.push_back({std::min(a, b), std::max(a, b), sections});
    }

    // Regions under objects and tiny ones go to the smallest neighbour: what is under the walls of a room to
    // the room, so that the cut is where nobody inside sees it. A hidden one does not go to a strip that is
    // narrower than a texel, whose only row of texels would come to lie at the border of the two.
    void uniteMinorRegions() {
        std::map<uint32_t, std::set<uint32_t>> neighborsOf;  // across walls
        for (const Contact& contact : contacts_) {
            const uint32_t a = sets_.find(contact.a), b = sets_.find(contact.b);
            if (a == b) continue;
            neighborsOf[a].insert(b);
            neighborsOf[b].insert(a);
        }
        std::map<uint32_t, std::vector<uint32_t>> members;
        for (const auto& [region, ignored] : neighborsOf) members[region];
        for (uint32_t t = 0; t < cutter_.triangles().size(); ++t)
            if (const auto found = members.find(sets_.find(t)); found != members.end())
                found->second.push_back(t);
        std::map<uint32_t, bool> minor, narrow;
        std::map<uint32_t, double> areas;
        for (const auto& [region, triangles] : members) {
            for (const uint32_t t : triangles) areas[region] += area(t);
            minor[region] = isMinor(triangles, areas[region]);
            narrow[region] = areas[region] < texelSize_ * double(boundsOf(triangles).diagonal());
        }
        for (const auto& [region, neighbors] : neighborsOf) {
            if (!minor[region]) continue;
            const auto isBetter = [&](uint32_t x, uint32_t y) {
                return std::make_tuple(minor[x], areas[x]) < std::make_tuple(minor[y], areas[y]);
            };
            const uint32_t best = *std::min_element(neighbors.begin(), neighbors.end(), isBetter);
            if (isTiny(areas[region]) || minor[best] || !narrow[best]) sets_.unite(region, best);
        }
    }

    bool isTiny(double total) const { return total < kMinAreaTexels * texelSize_ * texelSize_; }

    void add(Bounds& bounds, uint32_t triangle) const {
        for (const glm::dvec3& corner : corners(triangle)) bounds.add(glm::vec3(corner));
    }

    Bounds boundsOf(const std::vector<uint32_t>& triangles) const {
        Bounds bounds;
        for (const uint32_t t : triangles) add(bounds, t);
        return bounds;
    }

    bool isMinor(const std::vector<uint32_t>& triangles, double total) const {
        if (isTiny(total)) return true;
        const bool both = rays_.scene().materialOf(cutter_.origin(triangles[0])).doubleSided;
        return isHidden(triangles, total, 1) && (!both || isHidden(triangles, total, -1));
    }

    bool isHidden(const std::vector<uint32_t>& triangles, double total, float side) const {
        const auto isDark = [&](const Hit& hit) {
            return hit.backFace && !rays_.scene().materialOf(hit.triangle).doubleSided;
        };
        AreaPoints points(kPoints, total);
        double closed = 0;
        for (const uint32_t t : triangles)
            for (const auto& [position, seed] : points.next(corners(t), {0x3a1, cutter_.origin(t)})) {
                const glm::vec3 up = side * glm::vec3(normal(t));
                const Cover cover = coverOf({rays_.offsetOrigin(glm::vec3(position), up), frameFromNormal(up),
                                             kPressedTexels * float(texelSize_), seed + 1},
                                            rays_, isDark);
                closed += double(std::max(cover.dark, cover.touched));
            }
        return closed >= kMinCover * points.visited();
    }

    WallRegions result(size_t sectionCount) {
        WallRegions regions;
        std::map<uint32_t, uint32_t> number;
        for (uint32_t t = 0; t < cutter_.triangles().size(); ++t)
            regions.ofTriangle.push_back(
                number.try_emplace(sets_.find(t), uint32_t(number.size())).first->second);
        regions.separates.assign(sectionCount, 0);
        std::vector<std::vector<uint32_t>> across(number.size());
        for (const Contact& contact : contacts_) {
            const uint32_t a = regions.ofTriangle[contact.a], b = regions.ofTriangle[contact.b];
            if (a == b) continue;
            across[a].push_back(b);
            across[b].push_back(a);
            for (const uint32_t section : *contact.sections) regions.separates[section] = 1;
        }
        regions.part = partsOf(regions, across);
        return regions;
    }

    // Where a region is, and the plane of its largest triangle.
    struct Extent {
        uint32_t surface = 0;
        Bounds bounds;
        double area = 0;
        glm::dvec3 normal{0};
        double offset = 0;
    };

    std::vector<Extent> extentsOf(const WallRegions& regions, size_t count) const {
        std::vector<Extent> extents(count);
        for (uint32_t t = 0; t < regions.ofTriangle.size(); ++t) {
            Extent& extent = extents[regions.ofTriangle[t]];
            extent.surface = rays_.scene().triangleSurface[cutter_.origin(t)];
            add(extent.bounds, t);
            if (area(t) <= extent.area) continue;
            extent.area = area(t);
            extent.normal = normal(t);
            extent.offset = glm::dot(normal(t), cutter_.position(cutter_.triangles()[t][0]));
        }
        return extents;
    }

    // Whether the atlas could take two regions for one plane with a joint.
    bool couldJoin(const Extent& a, const Extent& b) const {
        const double apart = kApartTexels * texelSize_;
        return a.surface == b.surface && glm::dot(a.normal, b.normal) > kSamePlaneCosine &&
               std::abs(a.offset - b.offset) < apart &&
               glm::all(glm::lessThan(a.bounds.low - float(apart), b.bounds.high)) &&
               glm::all(glm::lessThan(b.bounds.low - float(apart), a.bounds.high));
    }

    // Greedy coloring: regions across a wall and those that could be joined are different parts.
    std::vector<uint32_t> partsOf(const WallRegions& regions,
                                  const std::vector<std::vector<uint32_t>>& across) const {
        const std::vector<Extent> extents = extentsOf(regions, across.size());
        std::vector<uint32_t> part(across.size(), 0), divided;
        for (uint32_t region = 0; region < across.size(); ++region) {
            if (across[region].empty()) continue;
            std::vector<uint8_t> taken(divided.size() + 1, 0);
            for (const uint32_t other : across[region])
                if (other < region) taken[part[other]] = 1;
            for (const uint32_t other : divided)
                if (couldJoin(extents[other], extents[region])) taken[part[other]] = 1;
            part[region] = uint32_t(std::find(taken.begin(), taken.end(), 0) - taken.begin());
            divided.push_back(region);
        }
        return part;
    }

    const MeshCutter& cutter_;
    const RayScene& rays_;
    const MeshTopology& topology_;
    double texelSize_;
    std::vector<Contact> contacts_;
    DisjointSets sets_;
};

}  // namespace

WallRegions findWallRegions(const MeshCutter& cutter, const RayScene& rays, const MeshTopology& topology,
                            double texelSizeMeters, size_t sectionCount) {
    return RegionFinder(cutter, rays, topology, texelSizeMeters).find(sectionCount);
}

}  // namespace phat
