#pragma once
// PHATexels: one sample of incident radiance a texel. source: Hensley et al. 2003, section 4.

#include <array>
#include <cstdint>
#include <vector>

#include "core/atlas/atlas.h"
#include "core/base/hemisphere_map.h"
#include "core/base/math.h"
#include "core/phatexel/depth_probes.h"
#include "core/phatexel/tile_patch.h"

namespace phat {

/// A PHATexel, unpacked, as the estimators use it.
struct Phatexel {
    glm::vec3 radiance{0};        // W/(m2 sr), arriving
    glm::vec3 directionBlock{0};  // unit, toward the light, in the block's frame (see blockFrames)
    float distance = 0;           // metres to the hit; kFarDistance: infinity
    float pdf = 0;                // 1/sr, of having chosen this direction
    bool valid = false;
};

/// The 8-byte storage: RGB9E5 radiance; 2x12 bits octahedral direction, 8 bits log distance.
/// Invalid: both words 0. source: ours, because the paper's 16 bytes carry no distance and waste half.
struct PackedPhatexel {
    uint32_t radiance = 0;           // RGB9E5, as GL_RGB9_E5
    uint32_t directionDistance = 0;  // bits 0-11 octahedral u, 12-23 v, 24-31 distance code, 0 = invalid
};

uint32_t packRgb9e5(glm::vec3 rgb);  // clamps to [0, 65408]; relative error of the largest channel <= 2^-9
glm::vec3 unpackRgb9e5(uint32_t packed);
/// 12+12 bit octahedral code of a unit direction; worst error 0.06 degrees.
uint32_t packOctahedral24(glm::vec3 direction);
glm::vec3 unpackOctahedral24(uint32_t packed);
/// Codes 1..254: a thousandth to a thousand units in equal ratios (5.6 %); 255: kFarDistance. `unitMeters`
/// here and below: Atlas::unitMeters.
uint32_t packDistance(float meters, float unitMeters);
float unpackDistance(uint32_t code, float unitMeters);

PackedPhatexel packPhatexel(const Phatexel& phatexel, float unitMeters);
/// The pdf is not in the bytes: it comes from the block's guide (or PhatexelLayer::pdf). Directions that
/// rounding put under the block's horizon are lifted onto it.
Phatexel unpackPhatexel(PackedPhatexel packed, float unitMeters);

/// The paper's 16-byte storage (section 6): three floats and two angles as halves in one channel.
/// No distance, no pdf. Files may use it (docs/format.md); renderers hold the 8 bytes.
struct PackedPhatexel16 {
    glm::vec3 radiance{0};
    uint32_t anglesHalf = 0;  // theta low, phi high; 0xffffffff: invalid
};
/// Angles are the nearest halves (theta within 2^-11 radians, phi within 2^-10) that keep the direction in
/// its cell of the block's guide: the density is read back from the cell. Where the nearest lie in another
/// cell, one of the halves beside them is taken. pre: directionBlock.z >= 0.
PackedPhatexel16 packPhatexel16(const Phatexel& phatexel);
/// `distance` is kFarDistance.
Phatexel unpackPhatexel16(PackedPhatexel16 packed);

/// A density over the block's hemisphere: an equal-area 16x16 histogram (hemisphere_map.h). Every cell weighs
/// at least 1 and all of them together kGuideTotal, so that one cell tells its density. Stored as it is
/// sampled: the pdf is exact after loading.
inline constexpr int kGuideSize = 16;
inline constexpr int kGuideCells = kGuideSize * kGuideSize;
inline constexpr uint32_t kGuideTotal = 1u << 16;
struct Guide {
    std::array<uint16_t, kGuideCells> weight;  // [y][x]
};

/// The guide closest to the given cell weights (any scale, >= 0; all zero: uniform), mixed with
/// `uniformFraction` of the uniform density.
Guide makeGuide(const std::array<float, kGuideCells>& cells, float uniformFraction);
Guide uniformGuide();
/// Cells weigh their mean cosine.
Guide cosineGuide();

/// Unit square to hemisphere by the guide's inverse distribution: rows first, then along the row.
glm::vec3 squareToGuide(const Guide& guide, glm::vec2 square);
/// Density of squareToGuide, 1/sr.
float squareToGuidePdf(const Guide& guide, glm::vec3 direction);
/// Inverse of squareToGuide.
glm::vec2 guideToSquare(const Guide& guide, glm::vec3 direction);

/// One PHATexel per texel of the atlas and layer.
struct PhatexelLayer {
    std::vector<PackedPhatexel> texels;  // [y][x]
    std::vector<float> pdf;              // [y][x], only where it does not follow from the guides; else empty
    /// [block], below 1024: the permutation of stratifiedSquare. Empty where directions follow no layout (the
    /// photon strategies): such PHATexels cannot be looked up.
    std::vector<uint16_t> scrambles;
};

/// All that a bake adds to a scene and its atlas.
struct Phatexture {
    std::vector<PhatexelLayer> indirect;  // light after at least one reflection
    std::vector<Guide> indirectGuides;    // [block]; uniform strategies: one guide for all
    std::vector<PhatexelLayer> area;      // light straight from emissive surfaces and the environment; 0 or 1
    std::vector<Guide> areaGuides;        // [block]
    std::vector<uint32_t> areaIrradiance;  // RGB9E5 [y][x], W/m2: the diffuse part of the same; may be empty
    std::vector<uint32_t> indirectIrradiance;  // RGB9E5 [y][x], W/m2: of all light that was reflected
    std::vector<PackedTile> tilePatches;       // [tileY][tileX]: where the texels are
    std::vector<DepthProbe> probes;            // [tileY][tileX]; empty where nothing can be looked up
};

/// PHATexel `texel` of a layer with its pdf filled in. `guides` as in Phatexture.
Phatexel phatexelAt(const PhatexelLayer& layer, const std::vector<Guide>& guides, const Atlas& atlas,
                    glm::uvec2 texel);

}  // namespace phat
