// Where each texel is in the world. source: Hensley et al. 2003, section 4.2 (extension past the edge).
// twin: web/src/texel_points.js.

#include <tbb/parallel_for.h>

#include <cmath>

#include "core/atlas/atlas.h"
#include "core/atlas/atlas_raster.h"

namespace phat {
namespace {

// How far gutters reach, in texels: twice the default gutter, which is one tile.
constexpr float kGutterReach = float(kTileSize);

// A triangle in texels and in the world, and the affine map from one to the other.
struct TexelTriangle {
    glm::dvec2 corner[3];
    glm::dvec3 position[3];
    glm::dmat2 barycentricFromTexel;  // weights of corner 1 and 2

    glm::dvec2 barycentricAt(glm::dvec2 p) const { return barycentricFromTexel * (p - corner[0]); }
    glm::dvec3 positionAt(glm::dvec2 b) const {
        return position[0] + b.x * (position[1] - position[0]) + b.y * (position[2] - position[0]);
    }
    glm::dvec2 texelAt(glm::dvec2 b) const {
        return corner[0] + b.x * (corner[1] - corner[0]) + b.y * (corner[2] - corner[0]);
    }
};

TexelTriangle texelTriangle(const Scene& scene, const Atlas& atlas, uint32_t triangle) {
    TexelTriangle result;
    for (int i = 0; i < 3; ++i) {
        result.corner[i] = atlas.triangleTexels[triangle][i];
        result.position[i] = scene.positions[scene.triangles[triangle][i]];
    }
    result.barycentricFromTexel =
        glm::inverse(glm::dmat2(result.corner[1] - result.corner[0], result.corner[2] - result.corner[0]));
    return result;
}

// Barycentrics of the triangle's point nearest to p. source: Ericson 2005, "Real-Time Collision Detection",
// 5.1.5, here edge by edge.
glm::dvec2 nearestBarycentric(const TexelTriangle& triangle, glm::dvec2 p) {
    const glm::dvec2 b = triangle.barycentricAt(p);
    if (b.x >= 0 && b.y >= 0 && b.x + b.y <= 1) return b;
    constexpr glm::dvec2 kCorner[3] = {{0, 0}, {1, 0}, {0, 1}};
    double best = INFINITY;
    glm::dvec2 nearest(0);
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const glm::dvec2 edge = triangle.corner[j] - triangle.corner[i], to = p - triangle.corner[i];
        const double along =
            std::clamp(glm::dot(to, edge) / std::max(glm::dot(edge, edge), 1e-300), 0.0, 1.0);
        const glm::dvec2 off = to - along * edge;
        if (glm::dot(off, off) >= best) continue;
        best = glm::dot(off, off);
        nearest = kCorner[i] + along * (kCorner[j] - kCorner[i]);
    }
    return nearest;
}

// The texels of one chart while they look for their triangles.
struct Claims {
    glm::ivec2 size{0};
    glm::vec2 origin{0};
    std::vector<uint32_t> triangle;  // kNoTriangle: none yet
    std::vector<float> distance;     // texels; 0: the centre is inside

    size_t index(int x, int y) const { return size_t(y) * size.x + x; }
};

class ChartRasterizer {
  public:
    ChartRasterizer(const Scene& scene, const Atlas& atlas, const Chart& chart, const uint32_t* begin,
                    const uint32_t* end)
        : scene_(scene), atlas_(atlas), begin_(begin), end_(end) {
        claims_.size = glm::ivec2(chart.sizeTexels());
        claims_.origin = glm::vec2(chart.originTexel());
        claims_.triangle.assign(size_t(claims_.size.x) * claims_.size.y, kNoTriangle);
        claims_.distance.assign(claims_.triangle.size(), INFINITY);
    }

    const Claims& run() {
        claimCentres();
        // A candidate travels one texel a round; the last two rounds let neighbours correct each other.
        for (int round = 0; round < int(kGutterReach) + 2; ++round) spread();
        return claims_;
    }

  private:
    // A centre belongs to the first triangle around it. A triangle around no centre, too small or too thin,
    // stakes a claim on the texel under its middle, so that gutters can find it and no chart is left empty.
    void claimCentres() {
        std::vector<uint32_t> small;
        for (const uint32_t* t = begin_; t != end_; ++t) {
            bool any = false;
            std::array<glm::vec2, 3> corners = atlas_.triangleTexels[*t];
            for (glm::vec2& c : corners) c -= claims_.origin;
            forEachTexel(corners, claims_.size.x, claims_.size.y, [&](int x, int y) {
                const size_t i = claims_.index(x, y);
                any = true;
                if (claims_.distance[i] == 0) return;
                claims_.triangle[i] = *t;
                claims_.distance[i] = 0;
            });
            if (!any) small.push_back(*t);
        }
        for (const uint32_t t : small) {
            const auto& corners = atlas_.triangleTexels[t];
            const glm::ivec2 texel((corners[0] + corners[1] + corners[2]) / 3.0f - claims_.origin);
            if (glm::any(glm::lessThan(texel, glm::ivec2(0)))) continue;
            if (glm::any(glm::greaterThanEqual(texel, claims_.size))) continue;
            offer(claims_, texel.x, texel.y, t);
        }
    }

    void offer(Claims& claims, int x, int y, uint32_t triangle) const {
        const size_t i = claims.index(x, y);
        if (claims.distance[i] == 0 || claims.triangle[i] == triangle) return;
        const TexelTriangle flat = texelTriangle(scene_, atlas_, triangle);
        const glm::dvec2 center = glm::dvec2(claims.origin) + glm::dvec2(x + 0.5, y + 0.5);
        // Never 0, which is reserved for the rasteriser's decision.
        const float distance =
            float(std::max(glm::distance(flat.texelAt(nearestBarycentric(flat, center)), center), 1e-6));
        const bool nearer = distance < claims.distance[i] ||
                            (distance == claims.distance[i] && triangle < claims.triangle[i]);
        if (!nearer || distance > kGutterReach) return;
        claims.triangle[i] = triangle;
        claims.distance[i] = distance;
    }

    void spread() {
        const Claims before = claims_;
        for (int y = 0; y < before.size.y; ++y) {
            for (int x = 0; x < before.size.x; ++x) {
                if (before.distance[before.index(x, y)] == 0) continue;
                for (int ny = std::max(0, y - 1); ny <= std::min(before.size.y - 1, y + 1); ++ny) {
                    for (int nx = std::max(0, x - 1); nx <= std::min(before.size.x - 1, x + 1); ++nx) {
                        const uint32_t candidate = before.triangle[before.index(nx, ny)];
                        if (candidate != kNoTriangle) offer(claims_, x, y, candidate);
                    }
                }
            }
        }
    }

    const Scene& scene_;
    const Atlas& atlas_;
    const uint32_t *begin_, *end_;
    Claims claims_;
};

glm::vec3 normalAt(const Scene& scene, uint32_t triangle, glm::vec2 clamped, glm::vec3 faceNormal) {
    const glm::uvec3& v = scene.triangles[triangle];
    if (scene.normals.size() != scene.positions.size()) return faceNormal;
    const glm::vec3 n = (1 - clamped.x - clamped.y) * scene.normals[v[0]] + clamped.x * scene.normals[v[1]] +
                        clamped.y * scene.normals[v[2]];
    const float length = glm::length(n);
    // Vertex normals that point through the surface would turn the hemisphere of directions inside out.
    if (!(length > 1e-6f && std::isfinite(length)) || !(glm::dot(n, faceNormal) > 0)) return faceNormal;
    return n / length;
}

/// Where a texel lies.
struct TexelOrigin {
    uint32_t triangle;
    glm::dvec2 frontTexel;  // its centre in the layout of the triangle's own chart
};

// Everything about texel `i`, one of `chart`.
void fillPoint(TexelPoints& points, size_t i, const Scene& scene, const Atlas& atlas, const Chart& chart,
               TexelOrigin origin) {
    const auto [triangle, frontTexel] = origin;
    const TexelTriangle flat = texelTriangle(scene, atlas, triangle);
    glm::dvec2 barycentric = flat.barycentricAt(frontTexel);
    const glm::dvec2 clamped = nearestBarycentric(flat, frontTexel);
    glm::dvec3 position = flat.positionAt(barycentric);
    // Clamp: triangles of a hundredth of a texel carry the rounding of their corners; extrapolating one over
    // several texels can go anywhere. The map is near-isometric (stretch 1.5), so twice the distance is too
    // far.
    const double reach = 2 * chart.texelSizeMeters * glm::distance(flat.texelAt(clamped), frontTexel);
    if (!(glm::distance(position, flat.positionAt(clamped)) <= reach + 1e-4 * chart.texelSizeMeters)) {
        barycentric = clamped;
        position = flat.positionAt(clamped);
    }

    const glm::dvec3 e1 = flat.position[1] - flat.position[0], e2 = flat.position[2] - flat.position[0];
    glm::vec3 faceNormal = glm::normalize(glm::cross(e1, e2));
    if (!isUnit(faceNormal))
        faceNormal = {0, 0, 1};  // no area: charts have such triangles in damaged files alone
    const glm::vec3 normal = normalAt(scene, triangle, clamped, faceNormal);
    const glm::dvec2 alongX = flat.barycentricFromTexel[0];
    const glm::vec3 tangent = alongX.x * e1 + alongX.y * e2;
    points.position[i] = position;
    points.normal[i] = chart.back ? -normal : normal;
    points.tangent[i] = frameFromNormalAndTangent(normal, tangent / glm::length(tangent)).tangent;
    points.triangle[i] = triangle;
    points.barycentric[i] = barycentric;
}

// Triangles listed by chart, ascending.
struct ChartTriangles {
    std::vector<uint32_t> first, triangle;
};

ChartTriangles trianglesByChart(const Atlas& atlas) {
    ChartTriangles lists;
    lists.first.assign(atlas.charts.size() + 1, 0);
    for (const uint32_t chart : atlas.triangleChart)
        if (chart != kNoChart) ++lists.first[chart + 1];
    for (size_t c = 0; c < atlas.charts.size(); ++c) lists.first[c + 1] += lists.first[c];
    lists.triangle.resize(lists.first.back());
    std::vector<uint32_t> next(lists.first.begin(), lists.first.end() - 1);
    for (uint32_t t = 0; t < atlas.triangleChart.size(); ++t)
        if (atlas.triangleChart[t] != kNoChart) lists.triangle[next[atlas.triangleChart[t]]++] = t;
    return lists;
}

}  // namespace

glm::vec3 flatNormalOf(const Scene& scene, const Atlas& atlas, const TexelPoints& points, size_t texel) {
    const glm::uvec2 xy(texel % atlas.sizeTexels.x, texel / atlas.sizeTexels.x);
    const bool back = atlas.charts[atlas.chartAt(xy)].back;
    const glm::uvec3 t = scene.triangles[points.triangle[texel]];
    const glm::vec3 normal =
        glm::cross(scene.positions[t.y] - scene.positions[t.x], scene.positions[t.z] - scene.positions[t.x]);
    return glm::normalize(back ? -normal : normal);
}

TexelPoints buildTexelPoints(const Scene& scene, const Atlas& atlas) {
    const size_t count = atlas.texelCount();
    TexelPoints points;
    points.sizeTexels = atlas.sizeTexels;
    points.state.assign(count, TexelState::unused);
    points.position.assign(count, glm::vec3(0));
    points.normal.assign(count, glm::vec3(0, 0, 1));
    points.tangent.assign(count, glm::vec3(1, 0, 0));
    points.triangle.assign(count, kNoTriangle);
    points.barycentric.assign(count, glm::vec2(0));

    const ChartTriangles lists = trianglesByChart(atlas);
    tbb::parallel_for(size_t(0), atlas.charts.size(), [&](size_t c) {
        const Chart& chart = atlas.charts[c];
        if (lists.first[c] == lists.first[c + 1]) return;  // filled with its other side
        ChartRasterizer rasterizer(scene, atlas, chart, &lists.triangle[lists.first[c]],
                                   &lists.triangle[0] + lists.first[c + 1]);
        const Claims& claims = rasterizer.run();
        const auto fill = [&](const Chart& target) {
            for (int y = 0; y < claims.size.y; ++y) {
                for (int x = 0; x < claims.size.x; ++x) {
                    const size_t claim = claims.index(x, y);
                    if (claims.triangle[claim] == kNoTriangle) continue;
                    const glm::uvec2 texel = target.originTexel() + glm::uvec2(x, y);
                    const size_t i = size_t(texel.y) * atlas.sizeTexels.x + texel.x;
                    points.state[i] = claims.distance[claim] == 0 ? TexelState::surface : TexelState::gutter;
                    fillPoint(
                        points, i, scene, atlas, target,
                        {claims.triangle[claim], glm::dvec2(claims.origin) + glm::dvec2(x + 0.5, y + 0.5)});
                }
            }
        };
        fill(chart);
        if (chart.otherSide != kNoChart) fill(atlas.charts[chart.otherSide]);
    });
    return points;
}

std::vector<Frame> blockFrames(const Atlas& atlas, const TexelPoints& points) {
    std::vector<Frame> frames(atlas.blockCount);
    tbb::parallel_for(size_t(0), atlas.charts.size(), [&](size_t c) {
        const Chart& chart = atlas.charts[c];
        std::vector<glm::dvec3> normal(size_t(chart.blocksWide()) * chart.blocksHigh(), glm::dvec3(0));
        std::vector<glm::dvec3> tangent = normal;
        const glm::uvec2 origin = chart.originTexel(), size = chart.sizeTexels();
        for (uint32_t y = 0; y < size.y; ++y) {
            for (uint32_t x = 0; x < size.x; ++x) {
                const size_t i = size_t(origin.y + y) * atlas.sizeTexels.x + origin.x + x;
                // Covered texels count: the frames must not depend on what is found out later.
                if (points.state[i] == TexelState::unused) continue;
                const size_t block = size_t(y / kBlockSize) * chart.blocksWide() + x / kBlockSize;
                normal[block] += glm::dvec3(points.normal[i]);
                tangent[block] += glm::dvec3(points.tangent[i]);
            }
        }
        for (size_t block = 0; block < normal.size(); ++block) {
            const double length = glm::length(normal[block]);
            if (!(length > 1e-9)) continue;
            frames[chart.firstBlock + block] =
                frameFromNormalAndTangent(glm::vec3(normal[block] / length), glm::vec3(tangent[block]));
        }
    });
    return frames;
}

}  // namespace phat
