#include "core/phatexel/tile_patch.h"

#include <oneapi/tbb/parallel_for.h>

#include <bit>
#include <limits>

#include "core/phatexel/phatexture.h"

namespace phat {
namespace {

constexpr int kTerms = 6;  // 1, x, y, x^2, x y, y^2
using Terms = std::array<double, kTerms>;

// Rounding. Axes differ from the block frame's by at most a texel a texel: charts lean less than 45 degrees
// and stretch less than 2. A bend of 1/16 is a radius of eight texels.
constexpr float kAxisSteps = 511.0f;
constexpr float kBendSteps = 127.0f * 16.0f;
// Texels of error, for each of a group's side, that the lookup does not see: a group of 2^k texels is asked
// about what is at least .28 4^k texels away, where the angle between two of its samples is 2^-k; this is
// about a tenth of it.
constexpr float kMaxErrorPerSide = 1.0f / 32.0f;
// The prior, an undistorted plane, weighs as much as this many texels. It decides where a tile has too few.
constexpr double kPriorTexels = 0.01;

int signedCode(float x, float steps, int most) {
    return std::clamp(int(std::lround(x * steps)), -most, most);
}
uint32_t bitsOf(int code, uint32_t bits) {
    return uint32_t(code) & ((1u << bits) - 1u);
}

Terms termsAt(glm::vec2 p) {
    return {1.0, p.x, p.y, double(p.x) * p.x, double(p.x) * p.y, double(p.y) * p.y};
}

// Normal equations of a weighted least-squares fit of three functions at once, solved by Cholesky's factors.
struct Fit {
    std::array<Terms, kTerms> matrix{};
    std::array<Terms, 3> right{};

    void add(const Terms& terms, glm::dvec3 value, double weight) {
        for (int i = 0; i < kTerms; ++i) {
            for (int j = 0; j <= i; ++j) matrix[i][j] += weight * terms[i] * terms[j];
            for (int c = 0; c < 3; ++c) right[c][i] += weight * terms[i] * value[c];
        }
    }
    void solve() {
        for (int i = 0; i < kTerms; ++i)
            for (int j = 0; j <= i; ++j) {
                double sum = matrix[i][j];
                for (int k = 0; k < j; ++k) sum -= matrix[i][k] * matrix[j][k];
                matrix[i][j] = i == j ? std::sqrt(sum) : sum / matrix[j][j];
            }
        for (Terms& x : right) {
            for (int i = 0; i < kTerms; ++i) {
                for (int k = 0; k < i; ++k) x[i] -= matrix[i][k] * x[k];
                x[i] /= matrix[i][i];
            }
            for (int i = kTerms - 1; i >= 0; --i) {
                for (int k = i + 1; k < kTerms; ++k) x[i] -= matrix[k][i] * x[k];
                x[i] /= matrix[i][i];
            }
        }
    }
};

glm::vec3 roundedAxis(glm::vec3 local, glm::vec3 plain) {
    glm::vec3 rounded(0);
    for (int c = 0; c < 3; ++c)
        rounded[c] = plain[c] + float(signedCode(local[c] - plain[c], kAxisSteps, 511)) / kAxisSteps;
    return rounded;
}

struct Region {
    const Atlas& atlas;
    const TexelPoints& points;
    glm::uvec2 tile;
    size_t indexOf(glm::uvec2 texel) const { return size_t(texel.y) * atlas.sizeTexels.x + texel.x; }
    glm::vec2 fromMiddle(glm::uvec2 texel) const {
        return glm::vec2(texel) + 0.5f - (glm::vec2(tile) + 0.5f) * float(kTileSize);
    }
};

void chooseProbe(TilePatch& patch, const Region& region) {
    float best = std::numeric_limits<float>::max();
    for (uint32_t i = 0; i < kTileSize * kTileSize; ++i) {
        const glm::uvec2 texel = region.tile * kTileSize + glm::uvec2(i % kTileSize, i / kTileSize);
        const size_t index = region.indexOf(texel);
        if (!region.points.valid(index)) continue;
        // Gutters may lie beyond what encloses the surface.
        const bool gutter = region.points.state[index] == TexelState::gutter;
        const float distance = glm::length(region.fromMiddle(texel)) + (gutter ? 2.0f * kTileSize : 0.0f);
        if (distance >= best) continue;
        best = distance;
        patch.probeTexel = i;
        patch.empty = false;
    }
}

uint32_t groupWhereItHolds(const TilePatch& patch, const Region& region, const Chart& chart,
                           glm::vec3 normal) {
    const glm::uvec2 low = chart.originTexel(), high = low + chart.sizeTexels();
    for (uint32_t bits = 5; bits > 3; --bits) {
        const uint32_t side = 1u << bits;
        const glm::uvec2 corner = low + (region.tile * kTileSize - low) / side * side;
        const glm::uvec2 end = glm::min(corner + side, high);
        bool holds = true;
        for (uint32_t y = corner.y; holds && y < end.y; ++y)
            for (uint32_t x = corner.x; holds && x < end.x; ++x) {
                const size_t index = region.indexOf({x, y});
                if (!region.points.valid(index)) continue;
                const glm::vec3 error =
                    patch.at(region.fromMiddle({x, y}), normal) - region.points.position[index];
                holds = glm::length(error) <= kMaxErrorPerSide * float(side) * chart.texelSizeMeters;
            }
        if (holds) return bits;
    }
    return 3;
}

TilePatch fitTile(const Region& region, const Chart& chart, const Frame& frame) {
    TilePatch patch;
    Fit fit;
    glm::dvec3 mean(0);
    int count = 0;
    const auto eachTexel = [&](const auto& body) {
        for (uint32_t i = 0; i < kTileSize * kTileSize; ++i) {
            const glm::uvec2 texel = region.tile * kTileSize + glm::uvec2(i % kTileSize, i / kTileSize);
            const size_t index = region.indexOf(texel);
            if (region.points.triangle[index] != kNoTriangle) body(texel, index);
        }
    };
    const double texelMeters = chart.texelSizeMeters;
    const auto plane = [&](glm::vec2 p) {
        return texelMeters *
               (double(p.x) * glm::dvec3(frame.tangent) + double(p.y) * glm::dvec3(frame.bitangent));
    };
    // The residual after the undistorted plane, in texels of the block's frame, and relative to its mean.
    eachTexel([&](glm::uvec2 texel, size_t index) {
        mean += glm::dvec3(region.points.position[index]) - plane(region.fromMiddle(texel));
        ++count;
    });
    if (count == 0) return patch;
    mean /= count;
    eachTexel([&](glm::uvec2 texel, size_t index) {
        const glm::vec2 p = region.fromMiddle(texel);
        const glm::dvec3 rest = glm::dvec3(region.points.position[index]) - plane(p) - mean;
        fit.add(termsAt(p), glm::dvec3(frame.toLocal(glm::vec3(rest / texelMeters))), 1.0);
    });
    constexpr double kScale = kTileSize / 2.0;
    const Terms sizes = {1, kScale, kScale, kScale * kScale, kScale * kScale, kScale * kScale};
    for (int i = 1; i < kTerms; ++i) {
        Terms one{};
        one[i] = sizes[i];
        fit.add(one, glm::dvec3(0), kPriorTexels);
    }
    fit.solve();

    const auto term = [&](int i) { return glm::vec3(fit.right[0][i], fit.right[1][i], fit.right[2][i]); };
    patch.center = glm::vec3(mean) + float(texelMeters) * frame.toWorld(term(0));
    const glm::vec3 x(1, 0, 0), y(0, 1, 0);
    patch.alongX = float(texelMeters) * frame.toWorld(roundedAxis(x + term(1), x));
    patch.alongY = float(texelMeters) * frame.toWorld(roundedAxis(y + term(2), y));
    for (int i = 0; i < 3; ++i)
        patch.bend[i] = float(texelMeters) * float(signedCode(term(3 + i).z, kBendSteps, 127)) / kBendSteps;
    chooseProbe(patch, region);
    patch.groupBits = groupWhereItHolds(patch, region, chart, frame.normal);
    return patch;
}

// Normal as packOctahedral24, the tangent's angle from frameFromNormal's in 12 bits.
glm::uvec2 packFrame(const Frame& frame) {
    const uint32_t code = packOctahedral24(frame.normal);
    const Frame base = frameFromNormal(unpackOctahedral24(code));
    const float angle =
        std::atan2(glm::dot(frame.tangent, base.bitangent), glm::dot(frame.tangent, base.tangent));
    return {code, uint32_t(int(std::lround(angle * (4096.0f / (2 * kPi))))) & 4095u};
}

}  // namespace

TilePatch fitTilePatch(const Atlas& atlas, const TexelPoints& points, const std::vector<Frame>& frames,
                       size_t tile) {
    const glm::uvec2 tilePosition(tile % atlas.sizeTiles().x, tile / atlas.sizeTiles().x);
    return fitTile({atlas, points, tilePosition}, atlas.charts[atlas.tileChart[tile]],
                   frames[atlas.blockAt(tilePosition * kTileSize)]);
}

std::vector<TilePatch> fitTilePatches(const Atlas& atlas, const TexelPoints& points,
                                      const std::vector<Frame>& frames) {
    const glm::uvec2 tiles = atlas.sizeTiles();
    std::vector<TilePatch> patches(size_t(tiles.x) * tiles.y);
    oneapi::tbb::parallel_for(uint32_t(0), tiles.y, [&](uint32_t y) {
        for (uint32_t x = 0; x < tiles.x; ++x) {
            const size_t tile = size_t(y) * tiles.x + x;
            if (atlas.tileChart[tile] != kNoChart) patches[tile] = fitTilePatch(atlas, points, frames, tile);
        }
    });
    return patches;
}

PackedTile packTile(const TilePatch& patch, const Frame& blockFrame, float texelMeters, uint32_t scramble,
                    glm::uvec2 probeRange) {
    const glm::uvec2 frame = packFrame(blockFrame);
    const auto axisBits = [&](glm::vec3 axis, glm::vec3 plain) {
        const glm::vec3 local = blockFrame.toLocal(axis) / texelMeters - plain;
        uint32_t bits = 0;
        for (int c = 0; c < 3; ++c) bits |= bitsOf(signedCode(local[c], kAxisSteps, 511), 10) << (10 * c);
        return bits;
    };
    const auto bend = [&](int i) {
        return bitsOf(signedCode(patch.bend[i] / texelMeters, kBendSteps, 127), 8);
    };
    return {glm::uvec4(std::bit_cast<uint32_t>(patch.center.x), std::bit_cast<uint32_t>(patch.center.y),
                       std::bit_cast<uint32_t>(patch.center.z),
                       scramble | (patch.groupBits - 3) << 10 | patch.probeTexel << 12 |
                           uint32_t(!patch.empty) << 18 | probeRange.x << 19 | (probeRange.y & 63u) << 25),
            glm::uvec4(frame.x | bend(0) << 24, frame.y | bend(1) << 12 | bend(2) << 20,
                       axisBits(patch.alongX, {1, 0, 0}), axisBits(patch.alongY, {0, 1, 0}))};
}

}  // namespace phat
