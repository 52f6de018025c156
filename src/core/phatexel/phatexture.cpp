#include "core/phatexel/phatexture.h"

#include <glm/gtc/packing.hpp>

#include "core/base/octahedral.h"

namespace phat {
namespace {

constexpr uint32_t kOctahedralMax = (1u << 12) - 1;

// Distance codes 1..254 span a thousandth to a thousand units; 255 is infinity, 0 marks an invalid PHATexel.
constexpr float kNearest = 1e-3f;       // units
constexpr float kOctaves = 19.931569f;  // log2 of a million
constexpr float kCodesPerOctave = 253.0f / kOctaves;
constexpr uint32_t kFarCode = 255;

glm::vec2 octahedralFold(glm::vec2 v) {
    return (1.0f - glm::abs(glm::vec2(v.y, v.x))) *
           glm::vec2(v.x >= 0.0f ? 1.0f : -1.0f, v.y >= 0.0f ? 1.0f : -1.0f);
}

using RowWeights = std::array<uint32_t, kGuideSize>;

// Rows of a guide are chosen by their total weight, then a cell within the row.
RowWeights sumRows(const Guide& guide) {
    RowWeights rows{};
    for (int i = 0; i < kGuideCells; ++i) rows[i / kGuideSize] += guide.weight[i];
    return rows;
}

// Walks a discrete distribution to `u`; returns the cell and u's position within it, both by reference order.
template <typename Weight>
int chooseCell(const Weight* weights, float total, float u, float& within) {
    float left = u * total;
    int cell = 0;
    while (cell < kGuideSize - 1 && left >= float(weights[cell])) left -= float(weights[cell++]);
    within = weights[cell] > 0 ? std::min(left / float(weights[cell]), 0x1.fffffep-1f) : 0.5f;
    return cell;
}

template <typename Weight>
float cumulatedBefore(const Weight* weights, int cell) {
    float sum = 0;
    for (int i = 0; i < cell; ++i) sum += float(weights[i]);
    return sum;
}

glm::ivec2 cellOf(glm::vec2 square) {
    return glm::clamp(glm::ivec2(square * float(kGuideSize)), 0, kGuideSize - 1);
}

glm::vec3 directionOfAngles(uint32_t anglesHalf) {
    const glm::vec2 angles = glm::unpackHalf2x16(anglesHalf);
    return {std::sin(angles.x) * std::cos(angles.y), std::sin(angles.x) * std::sin(angles.y),
            std::cos(angles.x)};
}

// The half that is `steps` further from zero, from 0 to `most`.
uint32_t steppedHalf(uint32_t half, int steps, int most) {
    return (half & 0x8000u) | uint32_t(std::clamp(int(half & 0x7fffu) + steps, 0, most));
}

}  // namespace

uint32_t packRgb9e5(glm::vec3 rgb) {
    // source: EXT_texture_shared_exponent; 9-bit mantissas without a leading one, exponent bias 15.
    constexpr int kMantissaBits = 9, kBias = 15, kMaxExponent = 31;
    constexpr float kLargest = 65408.0f;  // (511 / 512) * 2^16
    // The comparison also turns NaN into 0.
    for (int c = 0; c < 3; ++c) rgb[c] = rgb[c] > 0.0f ? std::min(rgb[c], kLargest) : 0.0f;
    const float largest = maxComponent(rgb);
    int exponent = std::max(-kBias - 1, largest > 0.0f ? std::ilogb(largest) : -kBias - 1) + 1 + kBias;
    float scale = std::ldexp(1.0f, exponent - kBias - kMantissaBits);
    if (int(std::floor(largest / scale + 0.5f)) == 1 << kMantissaBits) {
        ++exponent;
        scale *= 2.0f;
    }
    exponent = std::min(exponent, kMaxExponent);
    const glm::uvec3 mantissa(glm::floor(rgb / scale + 0.5f));
    return mantissa.x | (mantissa.y << 9) | (mantissa.z << 18) | (uint32_t(exponent) << 27);
}

glm::vec3 unpackRgb9e5(uint32_t packed) {
    // 2^(exponent - 15 - 9) by the bits of a float, whose bias is 127: this is the innermost step of many
    // loops.
    const float scale = std::bit_cast<float>(((packed >> 27) + 127u - 15u - 9u) << 23);
    return glm::vec3(packed & 511u, (packed >> 9) & 511u, (packed >> 18) & 511u) * scale;
}

uint32_t packOctahedral24(glm::vec3 d) {
    const glm::vec2 folded = octahedralFromDirection(d);
    const glm::vec2 scaled = glm::clamp(folded * 0.5f + 0.5f, 0.0f, 1.0f) * float(kOctahedralMax);
    const glm::uvec2 code(glm::floor(scaled + 0.5f));
    return code.x | (code.y << 12);
}

glm::vec3 unpackOctahedral24(uint32_t packed) {
    const glm::vec2 folded =
        glm::vec2(packed & kOctahedralMax, (packed >> 12) & kOctahedralMax) * (2.0f / kOctahedralMax) - 1.0f;
    glm::vec3 d(folded, 1.0f - std::abs(folded.x) - std::abs(folded.y));
    if (d.z < 0.0f) {
        const glm::vec2 unfolded = octahedralFold(glm::vec2(d));
        d.x = unfolded.x;
        d.y = unfolded.y;
    }
    return glm::normalize(d);
}

uint32_t packDistance(float meters, float unitMeters) {
    if (meters >= kFarDistance) return kFarCode;
    const float nearest = kNearest * unitMeters;
    const float code = std::log2(std::max(meters, nearest) / nearest) * kCodesPerOctave;
    return uint32_t(std::clamp(std::floor(code + 0.5f), 0.0f, 253.0f)) + 1;
}

float unpackDistance(uint32_t code, float unitMeters) {
    if (code == kFarCode) return kFarDistance;
    return kNearest * unitMeters * std::exp2(float(code - 1) / kCodesPerOctave);
}

PackedPhatexel packPhatexel(const Phatexel& phatexel, float unitMeters) {
    if (!phatexel.valid) return {};
    return {packRgb9e5(phatexel.radiance),
            packOctahedral24(phatexel.directionBlock) | (packDistance(phatexel.distance, unitMeters) << 24)};
}

Phatexel unpackPhatexel(PackedPhatexel packed, float unitMeters) {
    Phatexel phatexel;
    const uint32_t distanceCode = packed.directionDistance >> 24;
    if (distanceCode == 0) return phatexel;
    phatexel.radiance = unpackRgb9e5(packed.radiance);
    phatexel.directionBlock = unpackOctahedral24(packed.directionDistance & 0xffffffu);
    phatexel.directionBlock.z = std::max(phatexel.directionBlock.z, 0.0f);
    phatexel.distance = unpackDistance(distanceCode, unitMeters);
    phatexel.valid = true;
    return phatexel;
}

PackedPhatexel16 packPhatexel16(const Phatexel& phatexel) {
    if (!phatexel.valid) return {glm::vec3(0), ~0u};
    const glm::vec3 direction = phatexel.directionBlock;
    // The nearest halves of pi / 2 and of pi are less than these: none is under the horizon or past half a
    // turn.
    constexpr int kQuarterTurn = 0x3e48, kHalfTurn = 0x4248;
    const uint32_t nearest = glm::packHalf2x16({std::atan2(std::hypot(direction.x, direction.y), direction.z),
                                                std::atan2(direction.y, direction.x)});
    const glm::ivec2 cell = cellOf(hemisphereToSquare(direction));
    const auto keepsCell = [&](uint32_t angles) {
        return cellOf(hemisphereToSquare(directionOfAngles(angles))) == cell;
    };
    if (keepsCell(nearest)) return {phatexel.radiance, nearest};
    uint32_t best = nearest;
    float bestCosine = -1;
    for (int i = 0; i < 9; ++i) {
        const uint32_t angles = steppedHalf(nearest & 0xffffu, i % 3 - 1, kQuarterTurn) |
                                steppedHalf(nearest >> 16, i / 3 - 1, kHalfTurn) << 16;
        const float cosine = glm::dot(directionOfAngles(angles), direction);
        if (cosine <= bestCosine || !keepsCell(angles)) continue;
        best = angles;
        bestCosine = cosine;
    }
    return {phatexel.radiance, best};
}

Phatexel unpackPhatexel16(PackedPhatexel16 packed) {
    Phatexel phatexel;
    if (packed.anglesHalf == ~0u) return phatexel;
    phatexel.radiance = packed.radiance;
    phatexel.directionBlock = directionOfAngles(packed.anglesHalf);
    phatexel.distance = kFarDistance;
    phatexel.valid = true;
    return phatexel;
}

Guide makeGuide(const std::array<float, kGuideCells>& cells, float uniformFraction) {
    double sum = 0;
    for (float cell : cells) sum += cell;
    Guide guide;
    uint32_t total = 0;
    int heaviest = 0;
    for (int i = 0; i < kGuideCells; ++i) {
        const double probability =
            sum > 0 ? (1.0 - uniformFraction) * cells[i] / sum + uniformFraction / kGuideCells
                    : 1.0 / kGuideCells;
        guide.weight[i] = uint16_t(std::clamp(std::floor(probability * kGuideTotal), 1.0, 65535.0));
        total += guide.weight[i];
        if (guide.weight[i] > guide.weight[heaviest]) heaviest = i;
    }
    // Rounding leaves less than one unit a cell to hand out (or, where cells were lifted to 1, to take back):
    // the heaviest cell changes by the smallest ratio.
    guide.weight[heaviest] =
        uint16_t(int64_t(guide.weight[heaviest]) + int64_t(kGuideTotal) - int64_t(total));
    return guide;
}

Guide uniformGuide() {
    return makeGuide({}, 1.0f);
}

Guide cosineGuide() {
    constexpr int kSub = 16;
    std::array<float, kGuideCells> cells{};
    for (int y = 0; y < kGuideSize * kSub; ++y) {
        for (int x = 0; x < kGuideSize * kSub; ++x) {
            const glm::vec2 square = (glm::vec2(x, y) + 0.5f) / float(kGuideSize * kSub);
            cells[(y / kSub) * kGuideSize + x / kSub] += squareToHemisphere(square).z;
        }
    }
    return makeGuide(cells, 0.0f);
}

glm::vec3 squareToGuide(const Guide& guide, glm::vec2 square) {
    const RowWeights rows = sumRows(guide);
    glm::vec2 within;
    const int y = chooseCell(rows.data(), float(kGuideTotal), square.y, within.y);
    const int x = chooseCell(&guide.weight[y * kGuideSize], float(rows[y]), square.x, within.x);
    return squareToHemisphere((glm::vec2(x, y) + within) / float(kGuideSize));
}

float squareToGuidePdf(const Guide& guide, glm::vec3 direction) {
    if (direction.z < 0.0f) return 0.0f;
    const glm::ivec2 cell = cellOf(hemisphereToSquare(direction));
    constexpr float kDensityOfUnit = float(kGuideCells) / (2.0f * kPi * float(kGuideTotal));
    return float(guide.weight[cell.y * kGuideSize + cell.x]) * kDensityOfUnit;
}

glm::vec2 guideToSquare(const Guide& guide, glm::vec3 direction) {
    const RowWeights rows = sumRows(guide);
    const glm::vec2 square = hemisphereToSquare(direction);
    const glm::ivec2 cell = cellOf(square);
    const glm::vec2 within = square * float(kGuideSize) - glm::vec2(cell);
    const uint16_t* row = &guide.weight[cell.y * kGuideSize];
    const float x = cumulatedBefore(row, cell.x) + within.x * float(row[cell.x]);
    const float y = cumulatedBefore(rows.data(), cell.y) + within.y * float(rows[cell.y]);
    return {x / float(rows[cell.y]), y / float(kGuideTotal)};
}

Phatexel phatexelAt(const PhatexelLayer& layer, const std::vector<Guide>& guides, const Atlas& atlas,
                    glm::uvec2 texel) {
    const size_t index = size_t(texel.y) * atlas.sizeTexels.x + texel.x;
    Phatexel phatexel = unpackPhatexel(layer.texels[index], atlas.unitMeters);
    if (!phatexel.valid) return phatexel;
    if (!layer.pdf.empty()) {
        phatexel.pdf = layer.pdf[index];
    } else {
        const Guide& guide = guides.size() == 1 ? guides[0] : guides[atlas.blockAt(texel)];
        phatexel.pdf = squareToGuidePdf(guide, phatexel.directionBlock);
    }
    return phatexel;
}

}  // namespace phat
