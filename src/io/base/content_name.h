#pragma once
// Names of files by their content, so that a cache never serves an old file for a new one.

#include <cstdint>
#include <span>
#include <string>

namespace phat {

/// The CRC-32 of the bytes, eight digits.
std::string contentHash(std::span<const uint8_t> bytes);

/// STEM.HASH.EXTENSION
std::string contentName(const std::string& stem, std::span<const uint8_t> bytes,
                        const std::string& extension);

}  // namespace phat
