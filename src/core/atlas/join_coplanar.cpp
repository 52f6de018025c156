#include "core/atlas/join_coplanar.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>

#include "core/atlas/piece_place.h"
#include "core/base/disjoint_sets.h"

namespace phat {
namespace {

// Pieces are of one plane if their normals and directions agree to about this angle, and their planes to this
// part of a texel.
constexpr double kSameDegrees = 1.0;
constexpr double kSamePlaneTexels = 0.1;
// Joints up to this wide, texels: bilinear interpolation reaches across.
constexpr double kMaxJointTexels = 1.0;
// Boxes may overlap by so much, texels: rounding of positions.
constexpr double kMaxOverlapTexels = 0.02;
// Pieces that fill so much of their box together need not be tried in halves.
constexpr double kFullBox = 0.95;

/// A piece in the frame of its plane.
struct Part {
    uint32_t flat = 0;
    uint32_t turns = 0;
    glm::dvec2 low{0}, high{0};  // box, metres in that frame
};

struct Plane {
    glm::dvec3 normal, x, y;
};

using PlaneKey = std::tuple<uint32_t, int, int, int, int64_t, int>;

bool isPlanar(const Scene& scene, const FlatChart& flat, const PiecePose& pose, double tolerance) {
    for (const uint32_t t : flat.triangles)
        for (int corner = 0; corner < 3; ++corner) {
            const glm::dvec3 p = scene.positions[scene.triangles[t][corner]];
            if (std::abs(glm::dot(p - pose.center, pose.normal)) > tolerance) return false;
        }
    return true;
}

// Equal for pieces of one plane and direction but at the borders of its steps, where pieces stay apart.
PlaneKey keyOf(const PiecePose& pose, const PieceClass& kind) {
    const double step = std::sin(glm::radians(kSameDegrees));
    const glm::dvec3 n = glm::round(pose.normal / step);
    const double plane =
        std::round(glm::dot(pose.center, pose.normal) / (kSamePlaneTexels * kind.texelSizeMeters));
    // The direction, up to right angles.
    const Frame frame = frameFromNormal(glm::vec3(pose.normal));
    const double angle = std::atan2(glm::dot(pose.tangent, glm::dvec3(frame.bitangent)),
                                    glm::dot(pose.tangent, glm::dvec3(frame.tangent)));
    const int steps = int(std::round(90 / (2 * kSameDegrees)));
    const int direction = int(std::lround(glm::degrees(angle) / (2 * kSameDegrees)));
    return {kind.kind,
            int(n.x),
            int(n.y),
            int(n.z),
            int64_t(std::clamp(plane, -1e15, 1e15)),
            ((direction % steps) + steps) % steps};
}

glm::dvec2 inPlane(const Plane& plane, const glm::dvec3& p) {
    return {glm::dot(plane.x, p), glm::dot(plane.y, p)};
}

Part partOf(const Scene& scene, const std::vector<FlatChart>& flats, uint32_t f, const PiecePose& pose,
            const Plane& plane) {
    Part part;
    part.flat = f;
    part.turns = pose.turnToward(plane.x);
    const FlatChart& flat = flats[f];
    const glm::dvec3 corner = scene.positions[scene.triangles[flat.triangles[0]][0]];
    part.low = inPlane(plane, corner) - turnedPosition(flat.uvMeters[0][0], flat.sizeMeters, part.turns);
    part.high = part.low + turnedSize(flat.sizeMeters, part.turns);
    return part;
}

// Parts that touch, as sets of indices; parts that overlap another are alone.
std::vector<std::vector<Part>> touching(std::vector<Part> parts, double texelSizeMeters) {
    std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
        return std::tie(a.low.x, a.flat) < std::tie(b.low.x, b.flat);
    });
    const double joint = kMaxJointTexels * texelSizeMeters, overlap = kMaxOverlapTexels * texelSizeMeters;
    std::vector<uint8_t> overlaps(parts.size(), 0);
    std::vector<std::pair<uint32_t, uint32_t>> pairs;
    std::vector<uint32_t> open;
    for (uint32_t i = 0; i < parts.size(); ++i) {
        std::erase_if(open, [&](uint32_t j) { return parts[j].high.x + joint < parts[i].low.x; });
        for (const uint32_t j : open) {
            const glm::dvec2 apart =
                glm::max(parts[i].low, parts[j].low) - glm::min(parts[i].high, parts[j].high);
            if (std::max(apart.x, apart.y) > joint) continue;
            pairs.emplace_back(j, i);
            if (std::max(apart.x, apart.y) < -overlap) overlaps[i] = overlaps[j] = 1;
        }
        open.push_back(i);
    }
    DisjointSets sets(parts.size());
    for (const auto& [a, b] : pairs)
        if (!overlaps[a] && !overlaps[b]) sets.unite(a, b);
    std::map<size_t, std::vector<Part>> bySet;
    for (uint32_t i = 0; i < parts.size(); ++i) bySet[sets.find(i)].push_back(parts[i]);
    std::vector<std::vector<Part>> result;
    for (auto& [set, members] : bySet) result.push_back(std::move(members));
    return result;
}

struct Joiner {
    const std::vector<FlatChart>& flats;
    double texelSizeMeters;
    uint32_t gutterTexels;
    JoinedPieces& joined;

    /// Keeps the parts as one piece, or halves of them, whatever takes fewer texels.
    void join(std::vector<Part> parts) const {
        for (const std::vector<Part>& piece : divided(std::move(parts)).pieces) keep(piece);
    }

    struct Division {
        std::vector<std::vector<Part>> pieces;
        double texels = 0;
    };

    Division divided(std::vector<Part> parts) const {
        const auto [low, high] = boundsOf(parts);
        const glm::dvec2 size = high - low;
        Division whole{{}, texelsTaken(size / texelSizeMeters, gutterTexels)};
        double area = 0;
        for (const Part& part : parts) area += flats[part.flat].area;
        if (parts.size() == 1 || area >= kFullBox * size.x * size.y) {
            whole.pieces.push_back(std::move(parts));
            return whole;
        }
        // Halves of the longer side, by the middles of the parts.
        const int axis = size.x >= size.y ? 0 : 1;
        std::sort(parts.begin(), parts.end(), [&](const Part& a, const Part& b) {
            return std::make_tuple(a.low[axis] + a.high[axis], a.flat) <
                   std::make_tuple(b.low[axis] + b.high[axis], b.flat);
        });
        const auto middle = parts.begin() + std::ptrdiff_t(parts.size() / 2);
        Division halves = divided({parts.begin(), middle});
        Division others = divided({middle, parts.end()});
        halves.texels += others.texels;
        for (auto& piece : others.pieces) halves.pieces.push_back(std::move(piece));
        if (halves.texels < whole.texels) return halves;
        whole.pieces.push_back(std::move(parts));
        return whole;
    }

    static std::pair<glm::dvec2, glm::dvec2> boundsOf(const std::vector<Part>& parts) {
        glm::dvec2 low(1e300), high(-1e300);
        for (const Part& part : parts) {
            low = glm::min(low, part.low);
            high = glm::max(high, part.high);
        }
        return {low, high};
    }

    void keep(const std::vector<Part>& parts) const {
        const auto [low, high] = boundsOf(parts);
        const glm::dvec2 size = high - low;
        joined.member.push_back(parts[0].flat);
        if (parts.size() == 1) {
            joined.flats.push_back(flats[parts[0].flat]);
            return;
        }
        FlatChart flat;
        const uint32_t stands = size.y > size.x ? 1 : 0;
        flat.sizeMeters = turnedSize(size, stands);
        std::vector<std::pair<uint32_t, std::array<glm::dvec2, 3>>> triangles;
        for (const Part& part : parts) {
            const FlatChart& piece = flats[part.flat];
            flat.area += piece.area;
            flat.areaWithinStretch15 += piece.area * piece.areaWithinStretch15;
            for (size_t t = 0; t < piece.triangles.size(); ++t) {
                auto uv = piece.uvMeters[t];
                for (glm::dvec2& p : uv)
                    p = turnedPosition(turnedPosition(p, piece.sizeMeters, part.turns) + part.low - low, size,
                                       stands);
                triangles.emplace_back(piece.triangles[t], uv);
            }
        }
        flat.areaWithinStretch15 /= flat.area;
        std::sort(triangles.begin(), triangles.end(),
                  [](const auto& a, const auto& b) { return a.first < b.first; });
        for (const auto& [triangle, uv] : triangles) {
            flat.triangles.push_back(triangle);
            flat.uvMeters.push_back(uv);
        }
        joined.flats.push_back(std::move(flat));
    }
};

}  // namespace

JoinedPieces joinCoplanar(const Scene& scene, const MeshTopology& topology, std::vector<FlatChart> flats,
                          std::span<const PieceClass> classes, uint32_t gutterTexels) {
    std::map<PlaneKey, std::vector<uint32_t>> planes;
    std::vector<PiecePose> poses(flats.size());
    JoinedPieces joined;
    for (uint32_t f = 0; f < flats.size(); ++f) {
        poses[f] = poseOf(scene, topology, flats[f]);
        const double tolerance = 0.5 * kSamePlaneTexels * classes[f].texelSizeMeters;
        if (isPlanar(scene, flats[f], poses[f], tolerance))
            planes[keyOf(poses[f], classes[f])].push_back(f);
        else
            Joiner{flats, 0, 0, joined}.keep({{f, 0, {}, {}}});
    }
    for (const auto& [key, members] : planes) {
        const PiecePose& first = poses[members[0]];
        const Plane plane{first.normal, first.tangent, first.bitangent};
        std::vector<Part> parts;
        for (const uint32_t f : members) parts.push_back(partOf(scene, flats, f, poses[f], plane));
        const double texelSize = classes[members[0]].texelSizeMeters;
        for (std::vector<Part>& set : touching(std::move(parts), texelSize))
            Joiner{flats, texelSize, gutterTexels, joined}.join(std::move(set));
    }
    std::vector<uint32_t> order(joined.flats.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return joined.flats[a].triangles[0] < joined.flats[b].triangles[0];
    });
    JoinedPieces sorted;
    for (const uint32_t i : order) {
        sorted.flats.push_back(std::move(joined.flats[i]));
        sorted.member.push_back(joined.member[i]);
    }
    return sorted;
}

}  // namespace phat
