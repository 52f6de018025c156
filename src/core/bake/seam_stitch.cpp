#include "core/bake/seam_stitch.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/atlas/mesh_topology.h"
#include "core/atlas/texel_neighbors.h"

namespace phat {
namespace {

constexpr float kPointsPerTexel = 2.0f;
// Shading normals more than ten degrees apart are a crease. Smooth meshes have the same on both sides.
constexpr float kSmoothCosine = 0.985f;
// Corners of inner edges are equal but for rounding, texels.
constexpr float kSameCorner = 1e-3f;
// What a change of one costs against a jump of one over a texel's length: so little that jumps all but go,
// and enough to tell what the seams leave open. Gutters are extrapolated and give way first. Between a third
// and three times as much the pictures differ by less than the bake's noise.
constexpr float kSurfaceWeight = 0.03f, kGutterWeight = 0.003f;
// With a spread, jumps are mistakes of wide fits and all texels give way alike: where changes of neighbours
// are to be equal, with the weight c = kSpreadWeight spread^2, a change falls off over `spread` texels.
constexpr float kSpreadWeight = 0.003f;
// A change is solved for over so many spreads, where it has decayed to a twentieth.
constexpr float kSpreads = 3.0f;
// Of the first residual. Seventy rounds do.
constexpr double kStitched = 1e-4;
constexpr int kMaxRounds = 1000;

glm::vec3 faceNormalOf(const Scene& scene, uint32_t triangle) {
    const glm::uvec3& v = scene.triangles[triangle];
    return glm::normalize(glm::cross(glm::dvec3(scene.positions[v.y]) - glm::dvec3(scene.positions[v.x]),
                                     glm::dvec3(scene.positions[v.z]) - glm::dvec3(scene.positions[v.x])));
}

// As the texels have it: vertex normals that point through the surface do not count.
glm::vec3 cornerNormal(const Scene& scene, uint32_t triangle, uint32_t corner) {
    const glm::vec3 face = faceNormalOf(scene, triangle);
    if (scene.normals.size() != scene.positions.size()) return face;
    const glm::vec3 normal = scene.normals[scene.triangles[triangle][corner]];
    return glm::dot(normal, face) > 0 ? normal : face;
}

/// An edge from both sides, in one direction.
struct SharedEdge {
    std::array<uint32_t, 2> triangle;
    std::array<std::array<uint32_t, 2>, 2> corner;  // [side][end]
};

bool smooth(const Scene& scene, const SharedEdge& edge) {
    for (int end = 0; end < 2; ++end)
        if (glm::dot(cornerNormal(scene, edge.triangle[0], edge.corner[0][end]),
                     cornerNormal(scene, edge.triangle[1], edge.corner[1][end])) < kSmoothCosine)
            return false;
    return true;
}

void addPoints(const Atlas& atlas, const SharedEdge& edge, bool back, std::vector<SeamPoint>& points) {
    std::array<uint32_t, 2> chart;
    std::array<std::array<glm::vec2, 2>, 2> position;  // [side][end]
    for (int side = 0; side < 2; ++side) {
        const uint32_t own = atlas.triangleChart[edge.triangle[side]];
        if (own == kNoChart) return;
        chart[side] = atlas.charts[own].back == back ? own : atlas.charts[own].otherSide;
        if (chart[side] == kNoChart) return;
        const glm::vec2 shift =
            glm::vec2(atlas.charts[chart[side]].originTexel()) - glm::vec2(atlas.charts[own].originTexel());
        for (int end = 0; end < 2; ++end)
            position[side][end] = atlas.triangleTexels[edge.triangle[side]][edge.corner[side][end]] + shift;
    }
    if (chart[0] == chart[1] && glm::distance(position[0][0], position[1][0]) < kSameCorner &&
        glm::distance(position[0][1], position[1][1]) < kSameCorner)
        return;

    const float length = std::max(glm::distance(position[0][0], position[0][1]),
                                  glm::distance(position[1][0], position[1][1]));
    const int count = std::max(int(std::ceil(kPointsPerTexel * length)), 1);
    for (int i = 0; i < count; ++i) {
        const float t = (float(i) + 0.5f) / float(count);
        points.push_back(
            {chart,
             {glm::mix(position[0][0], position[0][1], t), glm::mix(position[1][0], position[1][1], t)},
             length / float(count)});
    }
}

struct Tap {
    uint32_t texel = 0;
    float weight = 0;
};

/// Texels of other charts have weight 0; the weights sum to 1.
std::array<Tap, 4> bilinearTaps(const Atlas& atlas, uint32_t chart, glm::vec2 position) {
    const glm::vec2 corner = glm::floor(position - 0.5f);
    const glm::vec2 t = position - 0.5f - corner;
    std::array<Tap, 4> taps;
    float sum = 0;
    for (int i = 0; i < 4; ++i) {
        const glm::ivec2 side(i & 1, i >> 1);
        const glm::ivec2 texel = glm::ivec2(corner) + side;
        if (glm::any(glm::lessThan(texel, glm::ivec2(0))) ||
            glm::any(glm::greaterThanEqual(texel, glm::ivec2(atlas.sizeTexels))) ||
            atlas.chartAt(texel) != chart)
            continue;
        taps[i].texel = uint32_t(texel.y) * atlas.sizeTexels.x + uint32_t(texel.x);
        taps[i].weight = (side.x == 1 ? t.x : 1.0f - t.x) * (side.y == 1 ? t.y : 1.0f - t.y);
        sum += taps[i].weight;
    }
    for (Tap& tap : taps) tap.weight = sum > 0 ? tap.weight / sum : 0.0f;
    return taps;
}

/// A weighted demand: the changes of the unknowns, by their taps, should sum to -jump.
struct Equation {
    std::array<Tap, 8> taps;  // texel: index of the unknown
    glm::vec3 jump{0};
    float weight = 0;
};

struct System {
    std::vector<Equation> equations;
    std::vector<uint32_t> texel;                 // per unknown
    std::vector<float> keep;                     // per unknown: what its change costs
    std::vector<std::array<uint32_t, 2>> links;  // neighbours in a chart, whose changes should be alike
    float linkWeight = 0;
    size_t size() const { return texel.size(); }
};

std::vector<uint8_t> knownCharts(const Atlas& atlas, const std::vector<uint8_t>& receives) {
    std::vector<uint8_t> known(atlas.charts.size(), 0);
    for (size_t i = 0; i < receives.size(); ++i)
        if (receives[i]) known[atlas.chartAt(i)] = 1;
    return known;
}

// Values under objects on the surface are extrapolated and must not affect the exposed texels.
bool isOccluded(const std::array<Tap, 4>& taps, const TexelPoints& points,
                const std::vector<uint8_t>& receives) {
    bool occluded = false;
    for (const Tap& tap : taps) {
        if (tap.weight <= 0) continue;
        if (receives[tap.texel]) return false;
        occluded |= points.state[tap.texel] == TexelState::occluded;
    }
    return occluded;
}

/// Calls visit(texel) for the neighbours of a texel in its piece of surface.
template <typename Visit>
void forNeighbors(const ReceiverTexels& texels, uint32_t texel, std::span<const glm::ivec2> offsets,
                  const Visit& visit) {
    const Atlas& atlas = texels.atlas;
    const TexelPoints& points = texels.points;
    if (points.triangle[texel] == kNoTriangle) return;
    const glm::ivec2 center(texel % atlas.sizeTexels.x, texel / atlas.sizeTexels.x);
    const uint32_t chart = atlas.chartAt(center);
    for (const glm::ivec2 offset : offsets) {
        const glm::ivec2 p = center + offset;
        if (glm::any(glm::lessThan(p, glm::ivec2(0))) ||
            glm::any(glm::greaterThanEqual(p, glm::ivec2(atlas.sizeTexels))) || atlas.chartAt(p) != chart)
            continue;
        const uint32_t other = uint32_t(p.y) * atlas.sizeTexels.x + uint32_t(p.x);
        if (points.triangle[other] != kNoTriangle && lieTogether(atlas, points, texel, other)) visit(other);
    }
}

System makeSystem(const IrradianceMap& map, const std::vector<SeamPoint>& seams, const ReceiverTexels& texels,
                  float spreadTexels) {
    const Atlas& atlas = texels.atlas;
    const TexelPoints& points = texels.points;
    const std::vector<uint8_t>& receives = texels.receives;
    const std::vector<uint8_t> known = knownCharts(atlas, receives);
    System system;
    constexpr uint32_t kNone = ~0u;
    std::vector<uint32_t> unknownOf(map.size(), kNone);
    const auto unknown = [&](uint32_t texel) {
        if (unknownOf[texel] == kNone) {
            unknownOf[texel] = uint32_t(system.texel.size());
            system.texel.push_back(texel);
            system.keep.push_back(spreadTexels > 0  ? kSpreadWeight
                                  : receives[texel] ? kSurfaceWeight
                                                    : kGutterWeight);
        }
        return unknownOf[texel];
    };
    for (const SeamPoint& seam : seams) {
        const std::array<Tap, 4> sides[2] = {bilinearTaps(atlas, seam.chart[0], seam.position[0]),
                                             bilinearTaps(atlas, seam.chart[1], seam.position[1])};
        if (!known[seam.chart[0]] || !known[seam.chart[1]] || isOccluded(sides[0], points, receives) ||
            isOccluded(sides[1], points, receives))
            continue;
        Equation equation;
        equation.weight = seam.weight;
        for (int i = 0; i < 8; ++i) {
            const Tap tap = sides[i / 4][i % 4];
            if (tap.weight <= 0) continue;
            equation.taps[i] = {unknown(tap.texel), i < 4 ? tap.weight : -tap.weight};
            equation.jump += equation.taps[i].weight * map[tap.texel];
        }
        system.equations.push_back(equation);
    }
    if (spreadTexels <= 0) return system;

    // The seams' texels have their numbers; now the rings around them.
    constexpr glm::ivec2 kAround[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    size_t inner = 0;
    for (int ring = 0; ring < int(std::ceil(kSpreads * spreadTexels)); ++ring)
        for (const size_t outer = system.size(); inner < outer; ++inner)
            forNeighbors(texels, system.texel[inner], kAround, [&](uint32_t texel) {
                if (receives[texel]) unknown(texel);
            });
    for (uint32_t u = 0; u < system.size(); ++u)
        forNeighbors(texels, system.texel[u], std::span(kAround).first(2), [&](uint32_t texel) {
            if (unknownOf[texel] != kNone) system.links.push_back({u, unknownOf[texel]});
        });
    system.linkWeight = kSpreadWeight * square(spreadTexels);
    return system;
}

using Values = std::vector<glm::vec3>;

/// The normal equations' matrix times `x`.
void multiply(const System& system, const Values& x, Values& out) {
    for (size_t i = 0; i < x.size(); ++i) out[i] = system.keep[i] * x[i];
    for (const Equation& equation : system.equations) {
        glm::vec3 sum(0);
        for (const Tap& tap : equation.taps) sum += tap.weight * x[tap.texel];
        sum *= equation.weight;
        for (const Tap& tap : equation.taps) out[tap.texel] += tap.weight * sum;
    }
    for (const auto& [a, b] : system.links) {
        const glm::vec3 pull = system.linkWeight * (x[a] - x[b]);
        out[a] += pull;
        out[b] -= pull;
    }
}

glm::dvec3 dot(const Values& a, const Values& b) {
    glm::dvec3 sum(0);
    for (size_t i = 0; i < a.size(); ++i) sum += glm::dvec3(a[i] * b[i]);
    return sum;
}

/// One step length a channel; 0 where there is nothing left to do.
glm::vec3 ratio(glm::dvec3 a, glm::dvec3 b) {
    glm::vec3 result(0);
    for (int i = 0; i < 3; ++i)
        if (b[i] > 0) result[i] = float(a[i] / b[i]);
    return result;
}

/// Conjugate gradients for all three channels at once. Seams are a small part of an atlas: one thread, in the
/// order of the unknowns, takes some milliseconds for a million texels.
Values solve(const System& system, const Progress& progress) {
    Values x(system.size(), glm::vec3(0)), residual = x, product = x;
    for (const Equation& equation : system.equations)
        for (const Tap& tap : equation.taps)
            residual[tap.texel] -= equation.weight * tap.weight * equation.jump;
    Values direction = residual;
    glm::dvec3 error = dot(residual, residual);
    const glm::dvec3 enough = kStitched * kStitched * error;
    for (int round = 0; round < kMaxRounds && glm::any(glm::greaterThan(error, enough)); ++round) {
        progress.throwIfStopped();
        multiply(system, direction, product);
        const glm::vec3 step = ratio(error, dot(direction, product));
        for (size_t u = 0; u < x.size(); ++u) {
            x[u] += step * direction[u];
            residual[u] -= step * product[u];
        }
        const glm::dvec3 next = dot(residual, residual);
        const glm::vec3 turn = ratio(next, error);
        for (size_t u = 0; u < x.size(); ++u) direction[u] = residual[u] + turn * direction[u];
        error = next;
    }
    return x;
}

}  // namespace

std::vector<SeamPoint> findSeams(const Scene& scene, const Atlas& atlas) {
    const MeshTopology topology = buildTopology(scene);
    const auto welded = [&](uint32_t triangle, uint32_t corner) {
        return topology.weldedVertex[scene.triangles[triangle][corner % 3]];
    };
    std::vector<SeamPoint> points;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
        for (uint32_t corner = 0; corner < 3; ++corner) {
            const uint32_t n = topology.neighborAcross[t][corner];
            if (n == kNoNeighbor || n < t) continue;
            const uint32_t next = (corner + 1) % 3;
            for (uint32_t other = 0; other < 3; ++other) {
                if (welded(n, other) != welded(t, next) || welded(n, other + 1) != welded(t, corner))
                    continue;
                const SharedEdge edge{{t, n}, {{{corner, next}, {(other + 1) % 3, other}}}};
                if (smooth(scene, edge))
                    for (const bool back : {false, true}) addPoints(atlas, edge, back, points);
                break;
            }
        }
    }
    return points;
}

glm::vec3 irradianceAt(const IrradianceMap& map, const Atlas& atlas, uint32_t chart, glm::vec2 position) {
    glm::vec3 sum(0);
    for (const Tap& tap : bilinearTaps(atlas, chart, position)) sum += tap.weight * map[tap.texel];
    return sum;
}

void stitchSeams(IrradianceMap& map, const std::vector<SeamPoint>& seams, const ReceiverTexels& texels,
                 float spreadTexels, const Progress& progress) {
    const System system = makeSystem(map, seams, texels, spreadTexels);
    const Values change = solve(system, progress);
    for (size_t u = 0; u < system.size(); ++u) {
        glm::vec3& value = map[system.texel[u]];
        value = glm::max(value + change[u], glm::vec3(0));
    }
}

}  // namespace phat
