#include "core/atlas/divided_surfaces.h"

#include <algorithm>
#include <cmath>

#include "core/atlas/dividing_sections.h"
#include "core/atlas/wall_regions.h"

namespace phat {
namespace {

constexpr double kToleranceTexels = 0.01;

// What is nearer than this is one point: rounding at the scene's far end counts, too.
double toleranceOf(const Scene& scene, double texelSizeMeters) {
    const Bounds bounds = boundsOf(scene);
    if (bounds.empty()) return 0;
    const glm::vec3 far = glm::max(glm::abs(bounds.low), glm::abs(bounds.high));
    return std::max(kToleranceTexels * texelSizeMeters, 0x1p-20 * double(maxComponent(far)));
}

// How many triangles a scene may become.
constexpr size_t kMaxFactor = 4, kAlwaysAllowed = 100'000;

// Whether the triangles did not become too many.
bool cutAll(MeshCutter& cutter, const std::vector<WallSection>& sections, size_t maxTriangles) {
    for (uint32_t i = 0; i < sections.size(); ++i) {
        cutter.cut(sections[i], i);
        if (cutter.triangles().size() > maxTriangles) return false;
    }
    return true;
}

// The surfaces with cut triangles. Triangles of the cut mesh are gathered by the surface's own
// triangles.
std::vector<DividedSurface> divisionOf(const Scene& scene, const MeshCutter& cutter,
                                       const WallRegions& regions) {
    std::vector<std::vector<uint32_t>> pieces(scene.triangles.size());
    for (uint32_t t = 0; t < cutter.triangles().size(); ++t) pieces[cutter.origin(t)].push_back(t);
    const auto partOf = [&](uint32_t triangle) { return regions.part[regions.ofTriangle[triangle]]; };

    std::vector<uint32_t> local(scene.positions.size() + cutter.newVertices().size(), ~0u);
    std::vector<uint8_t> seen(cutter.newVertices().size(), 0);  // a vertex belongs to one surface
    std::vector<DividedSurface> result;
    for (uint32_t s = 0; s < scene.surfaces.size(); ++s) {
        const Surface& surface = scene.surfaces[s];
        DividedSurface divided;
        divided.surface = s;
        const auto localOf = [&](uint32_t vertex) {
            if (vertex < scene.positions.size()) return vertex - surface.firstVertex;
            return local[vertex];
        };
        std::vector<uint32_t> made;
        for (uint32_t t = surface.firstTriangle; t < surface.firstTriangle + surface.triangleCount; ++t)
            for (const uint32_t piece : pieces[t]) {
                divided.part.push_back(partOf(piece));
                divided.partCount = std::max(divided.partCount, divided.part.back() + 1);
                for (int i = 0; i < 3; ++i)
                    if (cutter.triangles()[piece][i] >= scene.positions.size())
                        made.push_back(cutter.triangles()[piece][i]);
            }
        if (divided.partCount < 2 && divided.part.size() == surface.triangleCount) continue;
        // A new vertex comes from earlier ones, which may no longer be corners of any triangle.
        std::vector<uint32_t> open = made;
        while (!open.empty()) {
            const uint32_t index = open.back() - uint32_t(scene.positions.size());
            open.pop_back();
            if (seen[index]) continue;
            seen[index] = 1;
            for (const uint32_t from : cutter.newVertices()[index].from)
                if (from >= scene.positions.size()) {
                    made.push_back(from);
                    open.push_back(from);
                }
        }
        std::sort(made.begin(), made.end());
        made.erase(std::unique(made.begin(), made.end()), made.end());
        for (const uint32_t vertex : made) {
            local[vertex] = surface.vertexCount + uint32_t(divided.vertices.size());
            CutVertex added = cutter.newVertices()[vertex - scene.positions.size()];
            for (uint32_t& from : added.from) from = localOf(from);
            divided.vertices.push_back(added);
        }
        for (uint32_t t = surface.firstTriangle; t < surface.firstTriangle + surface.triangleCount; ++t)
            for (const uint32_t piece : pieces[t]) {
                const glm::uvec3& v = cutter.triangles()[piece];
                divided.triangles.push_back({localOf(v[0]), localOf(v[1]), localOf(v[2])});
            }
        result.push_back(std::move(divided));
    }
    return result;
}

}  // namespace

std::vector<DividedSurface> divideAtWalls(const RayScene& rays, double texelSizeMeters) {
    const Scene& scene = rays.scene();
    const MeshTopology topology = buildTopology(scene);
    std::vector<WallSection> sections =
        dividingSections(wallSections(rays, topology, texelSizeMeters), scene, topology, texelSizeMeters);
    if (sections.empty()) return {};
    const double tolerance = toleranceOf(scene, texelSizeMeters);
    const size_t maxTriangles = kMaxFactor * scene.triangles.size() + kAlwaysAllowed;
    {
        MeshCutter trial(scene, topology, tolerance);
        if (!cutAll(trial, sections, maxTriangles)) return {};
        const WallRegions regions = findWallRegions(trial, rays, topology, texelSizeMeters, sections.size());
        std::vector<WallSection> needed;
        for (size_t i = 0; i < sections.size(); ++i)
            if (regions.separates[i]) needed.push_back(sections[i]);
        sections = std::move(needed);
    }
    if (sections.empty()) return {};
    MeshCutter cutter(scene, topology, tolerance);
    if (!cutAll(cutter, sections, maxTriangles)) return {};
    return divisionOf(scene, cutter,
                      findWallRegions(cutter, rays, topology, texelSizeMeters, sections.size()));
}

}  // namespace phat
