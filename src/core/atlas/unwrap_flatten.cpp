#include "core/atlas/unwrap_flatten.h"

#include <algorithm>
#include <cmath>

namespace phat {
namespace {

// Per triangle: the surface's corners laid in the plane and the weights of the edges opposite to them.
struct FlatTriangle {
    glm::dvec2 rest[3];
    double weight[3];
};

// Cotangents outside these bounds belong to needles; holding them makes the system well conditioned and
// definite. A bias: needles count a little less or more than their area.
constexpr double kMinCotangent = 0.05, kMaxCotangent = 20;

std::vector<FlatTriangle> layTriangles(const ChartMesh& mesh) {
    std::vector<FlatTriangle> flat(mesh.triangles.size());
    for (size_t t = 0; t < flat.size(); ++t) {
        const auto& [a, b, c] = mesh.corners[t];
        const glm::dvec3 e1 = mesh.positions[b] - mesh.positions[a];
        const glm::dvec3 e2 = mesh.positions[c] - mesh.positions[a];
        const double length = glm::length(e1);
        const double doubleArea = glm::length(glm::cross(e1, e2));
        flat[t].rest[0] = {0, 0};
        flat[t].rest[1] = {length, 0};
        flat[t].rest[2] = {glm::dot(e1, e2) / length, doubleArea / length};
        for (int corner = 0; corner < 3; ++corner) {
            const glm::dvec2 p = flat[t].rest[corner];
            const double cotangent =
                glm::dot(flat[t].rest[(corner + 1) % 3] - p, flat[t].rest[(corner + 2) % 3] - p) / doubleArea;
            flat[t].weight[corner] = std::clamp(cotangent, kMinCotangent, kMaxCotangent);
        }
    }
    return flat;
}

// Symmetric Laplacian in compressed rows.
struct Laplacian {
    std::vector<uint32_t> firstEntry, column;
    std::vector<double> weight, diagonal;

    void multiply(const std::vector<glm::dvec2>& x, std::vector<glm::dvec2>& result) const {
        for (size_t row = 0; row < diagonal.size(); ++row) {
            glm::dvec2 sum = diagonal[row] * x[row];
            for (uint32_t k = firstEntry[row]; k < firstEntry[row + 1]; ++k) sum -= weight[k] * x[column[k]];
            result[row] = sum;
        }
    }
};

Laplacian buildLaplacian(const ChartMesh& mesh, const std::vector<FlatTriangle>& flat) {
    Laplacian matrix;
    const size_t n = mesh.vertexCount();
    matrix.diagonal.assign(n, 0.0);
    matrix.firstEntry.assign(n + 1, 0);
    for (const auto& corners : mesh.corners)
        for (const uint32_t v : corners) matrix.firstEntry[v + 1] += 2;
    for (size_t v = 0; v < n; ++v) matrix.firstEntry[v + 1] += matrix.firstEntry[v];
    matrix.column.resize(matrix.firstEntry[n]);
    matrix.weight.resize(matrix.firstEntry[n]);
    std::vector<uint32_t> fill(matrix.firstEntry.begin(), matrix.firstEntry.end() - 1);
    for (size_t t = 0; t < flat.size(); ++t) {
        for (int corner = 0; corner < 3; ++corner) {
            const uint32_t a = mesh.corners[t][(corner + 1) % 3], b = mesh.corners[t][(corner + 2) % 3];
            const double w = flat[t].weight[corner];
            matrix.diagonal[a] += w;
            matrix.diagonal[b] += w;
            matrix.column[fill[a]] = b;
            matrix.weight[fill[a]++] = w;
            matrix.column[fill[b]] = a;
            matrix.weight[fill[b]++] = w;
        }
    }
    return matrix;
}

double dotAll(const std::vector<glm::dvec2>& a, const std::vector<glm::dvec2>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += glm::dot(a[i], b[i]);
    return sum;
}

// Conjugate gradients with Jacobi's preconditioner, both coordinates at once. The matrix is singular (a shift
// changes nothing) but the right side is balanced, so that the iteration stays in the range.
void solve(const Laplacian& matrix, const std::vector<glm::dvec2>& right, std::vector<glm::dvec2>& x) {
    // Loose on purpose: the right side changes with the next outer iteration anyway.
    constexpr int kMaxIterations = 60;
    constexpr double kTolerance = 1e-4;

    const size_t n = x.size();
    std::vector<glm::dvec2> residual(n), z(n), direction(n), product(n);
    matrix.multiply(x, product);
    for (size_t i = 0; i < n; ++i) residual[i] = right[i] - product[i];
    for (size_t i = 0; i < n; ++i) z[i] = direction[i] = residual[i] / matrix.diagonal[i];
    double rz = dotAll(residual, z);
    const double target = kTolerance * kTolerance * dotAll(right, right);
    for (int iteration = 0; iteration < kMaxIterations && dotAll(residual, residual) > target; ++iteration) {
        matrix.multiply(direction, product);
        const double curvature = dotAll(direction, product);
        if (!(curvature > 0)) return;
        const double step = rz / curvature;
        for (size_t i = 0; i < n; ++i) {
            x[i] += step * direction[i];
            residual[i] -= step * product[i];
            z[i] = residual[i] / matrix.diagonal[i];
        }
        const double rzNext = dotAll(residual, z);
        const double blend = rzNext / rz;
        rz = rzNext;
        for (size_t i = 0; i < n; ++i) direction[i] = z[i] + blend * direction[i];
    }
}

// Weighted sum of the rest edges, each triangle turned by the rotation that fits the present state best.
std::vector<glm::dvec2> rotatedEdges(const ChartMesh& mesh, const std::vector<FlatTriangle>& flat,
                                     const std::vector<glm::dvec2>& uv) {
    std::vector<glm::dvec2> right(uv.size(), glm::dvec2(0));
    for (size_t t = 0; t < flat.size(); ++t) {
        glm::dvec2 rotation(0);  // cosine, sine
        for (int corner = 0; corner < 3; ++corner) {
            const int i = (corner + 1) % 3, j = (corner + 2) % 3;
            const glm::dvec2 u = uv[mesh.corners[t][j]] - uv[mesh.corners[t][i]];
            const glm::dvec2 x = flat[t].rest[j] - flat[t].rest[i];
            rotation += flat[t].weight[corner] * glm::dvec2(glm::dot(u, x), u.y * x.x - u.x * x.y);
        }
        const double length = glm::length(rotation);
        rotation = length > 0 ? rotation / length : glm::dvec2(1, 0);
        for (int corner = 0; corner < 3; ++corner) {
            const int i = (corner + 1) % 3, j = (corner + 2) % 3;
            const glm::dvec2 x = flat[t].weight[corner] * (flat[t].rest[j] - flat[t].rest[i]);
            const glm::dvec2 turned(rotation.x * x.x - rotation.y * x.y, rotation.y * x.x + rotation.x * x.y);
            right[mesh.corners[t][j]] += turned;
            right[mesh.corners[t][i]] -= turned;
        }
    }
    return right;
}

bool hasFlips(const ChartMesh& mesh, const std::vector<glm::dvec2>& uv) {
    for (const auto& [a, b, c] : mesh.corners) {
        const glm::dvec2 e1 = uv[b] - uv[a], e2 = uv[c] - uv[a];
        if (!(e1.x * e2.y - e1.y * e2.x > 0)) return true;
    }
    return false;
}

// Area-weighted mean of the symmetric Dirichlet energy, 1 when isometric: what decides whether an iteration
// helped. Infinite where a triangle is flipped. source: Smith and Schaefer 2015, section 3.
double distortion(const ChartMesh& mesh, const std::vector<FlatTriangle>& flat,
                  const std::vector<glm::dvec2>& uv) {
    double sum = 0, total = 0;
    for (size_t t = 0; t < flat.size(); ++t) {
        const glm::dmat2 j = uvFromSurface(mesh, uv, t);
        const double determinant = j[0][0] * j[1][1] - j[0][1] * j[1][0];
        if (!(determinant > 0)) return INFINITY;
        const double norm2 = glm::dot(j[0], j[0]) + glm::dot(j[1], j[1]);
        const double area = flat[t].rest[1].x * flat[t].rest[2].y;
        sum += area * 0.25 * norm2 * (1 + 1 / (determinant * determinant));
        total += area;
    }
    return sum / total;
}

void makeRigid(const ChartMesh& mesh, std::vector<glm::dvec2>& uv) {
    // Limits the time that large charts take.
    constexpr int kRounds = 10;
    constexpr double kMinGain = 1e-4;

    const std::vector<FlatTriangle> flat = layTriangles(mesh);
    const Laplacian matrix = buildLaplacian(mesh, flat);
    double best = distortion(mesh, flat, uv);
    for (int round = 0; round < kRounds; ++round) {
        std::vector<glm::dvec2> next = uv;
        solve(matrix, rotatedEdges(mesh, flat, uv), next);
        // Back off toward the last state until nothing is flipped and the distortion falls.
        double after = distortion(mesh, flat, next);
        for (int halving = 0; halving < 6 && !(after < best); ++halving) {
            for (size_t v = 0; v < uv.size(); ++v) next[v] = 0.5 * (next[v] + uv[v]);
            after = distortion(mesh, flat, next);
        }
        if (!(after < best)) return;
        const bool settled = best - after < kMinGain;
        uv.swap(next);
        best = after;
        if (settled) return;
    }
}

void scaleToArea(const ChartMesh& mesh, std::vector<glm::dvec2>& uv) {
    double surface = 0, plane = 0;
    for (const auto& [a, b, c] : mesh.corners) {
        surface += glm::length(
            glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
        const glm::dvec2 e1 = uv[b] - uv[a], e2 = uv[c] - uv[a];
        plane += e1.x * e2.y - e1.y * e2.x;
    }
    if (!(plane > 0)) return;
    for (glm::dvec2& p : uv) p *= std::sqrt(surface / plane);
}

}  // namespace

std::vector<glm::dvec2> flattenChart(const ChartMesh& mesh) {
    glm::dvec3 normalSum(0), center(0);
    for (const auto& [a, b, c] : mesh.corners)
        normalSum += glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    for (const glm::dvec3& p : mesh.positions) center += p / double(mesh.vertexCount());
    const glm::dvec3 normal = glm::normalize(normalSum);
    const glm::dvec3 helper = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 tangent = glm::normalize(glm::cross(helper, normal));
    const glm::dvec3 bitangent = glm::cross(normal, tangent);

    std::vector<glm::dvec2> uv(mesh.vertexCount());
    double size2 = 0, height = 0;
    for (size_t v = 0; v < uv.size(); ++v) {
        const glm::dvec3 p = mesh.positions[v] - center;
        uv[v] = {glm::dot(p, tangent), glm::dot(p, bitangent)};
        size2 = std::max(size2, glm::dot(uv[v], uv[v]));
        height = std::max(height, std::abs(glm::dot(p, normal)));
    }
    // Planar to float precision: the projection is the isometry.
    if (height * height <= 1e-10 * size2 && !hasFlips(mesh, uv)) return uv;

    scaleToArea(mesh, uv);
    if (!hasFlips(mesh, uv)) {
        makeRigid(mesh, uv);
        scaleToArea(mesh, uv);
    }
    return uv;
}

}  // namespace phat
