#include "core/scene/occluders.h"

#include <algorithm>
#include <map>

#include "core/scene/transparency.h"
#include "core/scene/triangle_corners.h"

namespace phat {
namespace {

constexpr int kMaxDivisions = 4;
// A triangle is divided as often along a side, at most, to be shared by the cells.
constexpr int kMaxSplits = 16;

/// What is occluded together: the triangles of a node.
struct Part {
    std::vector<uint32_t> triangles;
    Bounds bounds;
};

bool isOpaque(const Material& material) {
    return material.alphaMode != AlphaMode::blend && !isGlass(material);
}

std::vector<Part> partsOf(const Scene& scene, bool byNode) {
    std::map<uint32_t, Part> parts;
    for (const Surface& surface : scene.surfaces) {
        if (!isOpaque(scene.materials[surface.material])) continue;
        Part& part = parts[byNode ? surface.node : 0];
        for (uint32_t i = 0; i < surface.triangleCount; ++i) {
            part.triangles.push_back(surface.firstTriangle + i);
            for (const glm::vec3& corner : cornersOf(scene, surface.firstTriangle + i))
                part.bounds.add(corner);
        }
    }
    std::vector<Part> result;
    for (auto& [node, part] : parts)
        if (!part.triangles.empty()) result.push_back(std::move(part));
    return result;
}

struct Cell {
    double area = 0;
    glm::dvec3 weighted{0};    // sum of area times place
    glm::dmat3 directions{0};  // of A n n^T

    Occluder occluder() const {
        constexpr double kRound = 3.0 / 16;
        return {glm::vec3(weighted / area), glm::mat3(kRound * area * directions)};
    }
};

/// A grid over the box of a part.
struct Cells {
    glm::vec3 low, size;
    glm::ivec3 count;

    Cells(const Bounds& bounds, int divisions) : low(bounds.low), size(bounds.high - bounds.low) {
        const float least = std::min({size.x, size.y, size.z}), most = maxComponent(size);
        const float side = std::max({least, most / float(divisions), 1e-30f});
        count = glm::max(glm::ivec3(size / side + 0.5f), 1);
        size = glm::max(size / glm::vec3(count), 1e-30f);
    }
    size_t at(glm::vec3 p) const {
        const glm::ivec3 cell = glm::clamp(glm::ivec3((p - low) / size), glm::ivec3(0), count - 1);
        return (size_t(cell.z) * count.y + cell.y) * count.x + cell.x;
    }
};

// Adds a triangle's area, in small equal triangles, to the cells that it is in.
void share(const std::array<glm::vec3, 3>& corners, const Cells& cells, std::vector<Cell>& sums) {
    const auto& [a, b, c] = corners;
    const float longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    const float shortest = std::min({cells.size.x, cells.size.y, cells.size.z});
    const int n = int(
        std::clamp(std::ceil(4 * longest / std::max(shortest, 1e-6f * longest)), 1.0f, float(kMaxSplits)));
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double whole = 0.5 * glm::length(cross), area = whole / (n * n);
    if (!(whole > 0)) return;
    const glm::dvec3 normal = cross / (2 * whole);
    const glm::dmat3 directions = area * glm::outerProduct(normal, normal);
    const auto add = [&](int twiceI, int twiceJ) {
        const glm::vec3 p = a + (float(twiceI) * (b - a) + float(twiceJ) * (c - a)) / float(3 * n);
        Cell& cell = sums[cells.at(p)];
        cell.area += area;
        cell.weighted += area * glm::dvec3(p);
        cell.directions += directions;
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j) {
            add(3 * i + 1, 3 * j + 1);
            if (i + j + 1 < n) add(3 * i + 2, 3 * j + 2);
        }
}

void addOccluders(const Scene& scene, const Part& part, int divisions, std::vector<Occluder>& occluders) {
    const Cells cells(part.bounds, divisions);
    std::vector<Cell> sums(size_t(cells.count.x) * cells.count.y * cells.count.z);
    for (const uint32_t triangle : part.triangles) share(cornersOf(scene, triangle), cells, sums);
    for (const Cell& cell : sums)
        if (cell.area > 0) occluders.push_back(cell.occluder());
}

}  // namespace

float sphereOcclusion(glm::vec3 towardCenter, float radius, glm::vec3 normal) {
    const float distance = glm::length(towardCenter), relative = distance / radius;
    const float squared = relative * relative;
    if (!(squared > 1)) return 1;
    const float cosine = glm::dot(normal, towardCenter) / distance;
    const float cut = 1 - squared * cosine * cosine;
    if (!(cut > 0)) return std::max(cosine, 0.0f) / squared;
    const float outside = squared - 1;
    const float angle =
        std::acos(std::clamp(-cosine * std::sqrt(outside / (1 - cosine * cosine)), -1.0f, 1.0f));
    const float part =
        (cosine * angle - std::sqrt(cut * outside)) / squared + std::atan(std::sqrt(cut / outside));
    return std::clamp(part / kPi, 0.0f, 1.0f);
}

float occlusionBy(const Occluder& occluder, glm::vec3 position, glm::vec3 normal) {
    const glm::vec3 toward = occluder.center - position;
    const float distance = glm::length(toward);
    if (!(distance > 0)) return 1;
    const glm::vec3 direction = toward / distance;
    const float shadow = std::sqrt(std::max(glm::dot(direction, occluder.squaredShadow * direction), 0.0f));
    return shadow > 0 ? sphereOcclusion(toward, std::sqrt(shadow / kPi), normal) : 0.0f;
}

std::vector<Occluder> occludersOf(const Scene& things) {
    std::vector<Part> parts = partsOf(things, true);
    if (parts.size() > kMaxOccluders) parts = partsOf(things, false);
    std::vector<Occluder> occluders;
    for (int divisions = kMaxDivisions; divisions > 0; --divisions) {
        occluders.clear();
        for (const Part& part : parts) addOccluders(things, part, divisions, occluders);
        if (occluders.size() <= kMaxOccluders) break;
    }
    return occluders;
}

std::array<glm::vec4, 3> rowsOf(const Occluder& occluder) {
    const glm::mat3& m = occluder.squaredShadow;
    return {glm::vec4(occluder.center, m[0][0]), glm::vec4(m[1][1], m[2][2], m[1][0], m[2][0]),
            glm::vec4(m[2][1], 0, 0, 0)};
}

}  // namespace phat
