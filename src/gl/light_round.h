#pragma once
// What the GPU is told to do for the light, and what it has made.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "core/dynamic/block_order.h"
#include "core/phatexel/phatexture.h"

namespace phat {

enum class RayChoice : uint8_t {
    stored,  // the directions that PHATexels have; by the guides where they have none
    guided,  // others, by guides of their blocks that follow the light
};

/// One sample for every texel of some blocks of the atlas.
struct LightRound {
    std::span<const BlockTurn> blocks;
    uint32_t number = 0;  // of the round, for its random numbers
    RayChoice directions = RayChoice::stored;
    bool phatexels = true, irradiance = true;  // what is made
    bool compares = false;                     // new PHATexels with those before; waits for the GPU
};

/// All of an atlas [y][x], read back.
struct StoredLight {
    std::vector<std::vector<PackedPhatexel>> phatexels;  // [layer] of all sources
    std::array<std::vector<Guide>, 2> guides;            // [block] as Phatexture: indirect, area
    std::array<std::vector<glm::vec3>, 2> irradiance;    // W/m2: indirect, area lights
    std::vector<glm::vec4> tileLight;                    // [tileY][tileX], see tileLight()
};

}  // namespace phat
