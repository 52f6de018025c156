#include "core/atlas/wall_sections.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>

namespace phat {
namespace {

constexpr double kLiftTexels = 1.0 / 16;
constexpr double kExtendTexels = 0.25, kExtendLength = 0.5;
constexpr double kMinTexels = 0.01;  // of a section: the direction of shorter ones is rounding
// Along an edge of a triangle, this far inside or outside of it, a wall stands on the edge. Inside, because
// what leans over the surface is cut a little above its foot.
constexpr double kSnapTexels = 0.125, kSnapAltitude = 0.1, kOutsideTexels = 0.01;
// A wall that leans less than 18 degrees over a surface is a cover of it.
constexpr double kMaxParallel = 0.95;

struct Triangle {
    glm::dvec3 corner[3];
    glm::dvec3 normal;
};

struct Segment {
    glm::dvec3 from, to;
};

// Which nodes an animation moves, with all below them.
std::vector<uint8_t> animatedNodes(const Scene& scene) {
    std::vector<uint8_t> animated(scene.nodes.size(), 0);
    for (const Animation& animation : scene.animations)
        for (const AnimationChannel& channel : animation.channels)
            if (channel.node < animated.size()) animated[channel.node] = 1;
    std::vector<uint8_t> withAbove = animated;
    for (size_t n = 0; n < animated.size(); ++n)
        for (int32_t above = scene.nodes[n].parent; above >= 0; above = scene.nodes[size_t(above)].parent)
            withAbove[n] |= animated[size_t(above)];
    return withAbove;
}

// Per surface.
std::vector<uint8_t> solidSurfaces(const RayScene& rays) {
    const Scene& scene = rays.scene();
    const std::vector<uint8_t> animated = animatedNodes(scene);
    std::vector<uint8_t> solid;
    for (const Surface& surface : scene.surfaces) {
        const bool opaque = scene.materials[surface.material].alphaMode == AlphaMode::opaque &&
                            surface.triangleCount > 0 && rays.glassOf(surface.firstTriangle) == Glass::none;
        solid.push_back(opaque && !(surface.node < animated.size() && animated[surface.node]));
    }
    return solid;
}

bool isNeighbor(const MeshTopology& topology, uint32_t a, uint32_t b) {
    const auto& across = topology.neighborAcross[a];
    return std::find(across.begin(), across.end(), b) != across.end();
}

Triangle triangleOf(const Scene& scene, const MeshTopology& topology, uint32_t index) {
    const glm::uvec3& v = scene.triangles[index];
    return {{scene.positions[v[0]], scene.positions[v[1]], scene.positions[v[2]]},
            topology.faceNormal[index]};
}

// Where `wall` crosses the plane `lift` above the triangle, moved down onto the triangle's plane.
std::optional<Segment> crossing(const Triangle& triangle, const Triangle& wall, glm::dvec3 lift) {
    const glm::dvec3 up = glm::normalize(lift);
    double height[3];
    for (int i = 0; i < 3; ++i) height[i] = glm::dot(up, wall.corner[i] - triangle.corner[0] - lift);
    glm::dvec3 ends[2];
    int count = 0;
    for (int i = 0; i < 3 && count < 2; ++i) {
        const int j = (i + 1) % 3;
        if ((height[i] < 0) == (height[j] < 0)) continue;
        const double t = height[i] / (height[i] - height[j]);
        ends[count++] = glm::mix(wall.corner[i], wall.corner[j], t) - lift;
    }
    if (count < 2) return std::nullopt;
    return Segment{ends[0], ends[1]};
}

// The lines that bound a triangle.
struct Borders {
    glm::dvec3 corner[3], inward[3];

    explicit Borders(const Triangle& triangle) {
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 edge = triangle.corner[(i + 1) % 3] - triangle.corner[i];
            corner[i] = triangle.corner[i];
            inward[i] = glm::normalize(glm::cross(triangle.normal, edge));
        }
    }
    double depth(int edge, glm::dvec3 point) const { return glm::dot(inward[edge], point - corner[edge]); }
};

// A segment that is all but on one edge of the triangle moves onto it; -1: it is not.
int snapToEdge(const Borders& borders, double texelSizeMeters, Segment& segment) {
    int nearest = -1;
    double least = 1e300;
    for (int i = 0; i < 3; ++i) {
        const double altitude = borders.depth(i, borders.corner[(i + 2) % 3]);
        const double from = borders.depth(i, segment.from), to = borders.depth(i, segment.to);
        if (std::min(from, to) < -kOutsideTexels * texelSizeMeters) continue;
        const double farthest = std::max(from, to);
        if (farthest > std::min(kSnapTexels * texelSizeMeters, kSnapAltitude * altitude)) continue;
        if (farthest >= least) continue;
        least = farthest;
        nearest = i;
    }
    if (nearest >= 0)
        for (glm::dvec3* end : {&segment.from, &segment.to})
            *end -= borders.depth(nearest, *end) * borders.inward[nearest];
    return nearest;
}

// The part of a segment of the triangle's plane that is inside the triangle, longer at both ends where the
// triangle is.
std::optional<Segment> clipped(const Triangle& triangle, Segment segment, double texelSizeMeters) {
    const Borders borders(triangle);
    const int on = snapToEdge(borders, texelSizeMeters, segment);
    const double length = glm::distance(segment.from, segment.to);
    if (!(length > kMinTexels * texelSizeMeters)) return std::nullopt;
    const glm::dvec3 direction = (segment.to - segment.from) / length;
    double low = -std::min(kExtendTexels * texelSizeMeters, kExtendLength * length), high = length - low;
    for (int i = 0; i < 3; ++i) {
        if (i == on) continue;
        const double depth = borders.depth(i, segment.from), slope = glm::dot(borders.inward[i], direction);
        if (slope == 0) {
            if (depth < 0) return std::nullopt;
            continue;
        }
        if (slope > 0)
            low = std::max(low, -depth / slope);
        else
            high = std::min(high, -depth / slope);
    }
    // An overhang alone is no wall on this triangle.
    if (high <= low || high <= 0 || low >= length) return std::nullopt;
    return Segment{segment.from + low * direction, segment.from + high * direction};
}

}  // namespace

std::vector<WallSection> wallSections(const RayScene& rays, const MeshTopology& topology,
                                      double texelSizeMeters) {
    const Scene& scene = rays.scene();
    const std::vector<uint8_t> solid = solidSurfaces(rays);
    const auto counts = [&](uint32_t t) {
        return solid[scene.triangleSurface[t]] && !topology.degenerate(t);
    };
    const double lift = kLiftTexels * texelSizeMeters;

    std::vector<std::vector<WallSection>> ofTriangle(scene.triangles.size());
    tbb::parallel_for(uint32_t(0), uint32_t(scene.triangles.size()), [&](uint32_t t) {
        if (!counts(t)) return;
        const Triangle triangle = triangleOf(scene, topology, t);
        const glm::dvec3 center = (triangle.corner[0] + triangle.corner[1] + triangle.corner[2]) / 3.0;
        double radius = 0;
        for (const glm::dvec3& corner : triangle.corner)
            radius = std::max(radius, glm::distance(center, corner));
        const int sides = scene.materialOf(t).doubleSided ? 2 : 1;
        for (const uint32_t w : rays.trianglesNear(center, float(radius + 2 * lift))) {
            // The surface itself, where it goes on around a corner, is no wall.
            if (w == t || !counts(w) || isNeighbor(topology, t, w)) continue;
            const Triangle wall = triangleOf(scene, topology, w);
            if (std::abs(glm::dot(wall.normal, triangle.normal)) > kMaxParallel) continue;
            for (int side = 0; side < sides; ++side) {
                const auto across = crossing(triangle, wall, (side ? -lift : lift) * triangle.normal);
                const auto inside = across ? clipped(triangle, *across, texelSizeMeters) : std::nullopt;
                if (inside) ofTriangle[t].push_back({t, inside->from, inside->to});
            }
        }
    });
    std::vector<WallSection> all;
    for (const auto& sections : ofTriangle) all.insert(all.end(), sections.begin(), sections.end());
    return all;
}

}  // namespace phat
